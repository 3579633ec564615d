// Depth from pressure: P = P_surface + ρ g d.
#pragma once
#include <stdint.h>

namespace mucat {

// The pressure at the surface: the mean of the first readings after power-on. It outlives every reset that
// its memory outlives, so that a restart under water does not move the surface.
class Surface {
 public:
  // Restores the pressure from before the reset, if memory holds a plausible one.
  void start();
  bool known() const { return readings_ == kReadings; }
  // Adds a reading (Pa) at the surface, until the surface is known. The last one stores the mean in memory
  // that survives a reset.
  void add(int32_t pressure);
  // Depth in mm, downwards, in water of this density (kg/m³); only once the surface is known.
  int16_t depth(int32_t pressure, uint16_t density) const;
  // It is measured anew.
  void forget();

 private:
  static constexpr uint8_t kReadings = 16;

  int32_t pressure_ = 0;  // the sum of the readings until known
  uint8_t readings_ = 0;
};

}  // namespace mucat
