// Depth from pressure: P = P_surface + ρ g d.
#pragma once
#include <stdint.h>

namespace mucat {

// The pressure at the surface: the mean of the first readings after power-on. It is never measured under
// water: memory holds it over every reset that the memory outlives, and EEPROM holds it while the robot is
// armed or submerged.
class Surface {
 public:
  // Restores the pressure from before the reset, if memory or EEPROM holds a plausible one.
  void start();
  bool known() const { return readings_ == kReadings; }
  // True if it is that of EEPROM, and the robot has not been at that depth of zero since: the supply failed
  // under water, or has come back in other weather or at another height.
  bool uncertain() const { return uncertain_; }
  // Call every tick with the newest pressure (Pa): puts the surface into EEPROM, or out of it, a byte a tick.
  void step(int32_t pressure, bool armed);
  // Adds a reading (Pa) at the surface, until the surface is known, which is their mean.
  void add(int32_t pressure);
  // Depth in mm, downwards, in water of this density (kg/m³); only once the surface is known.
  int16_t depth(int32_t pressure, uint16_t density) const;
  // It is measured anew.
  void forget();

 private:
  static constexpr uint8_t kReadings = 16;
  // In 2 Pa. A record whose second word is not the complement of its first is none.
  struct Record {
    uint16_t value;
    uint16_t complement;
  };

  void set_recorded(bool recorded);
  // Stores a certain surface in memory that survives a reset.
  void retain();
  void restore(int32_t pressure);

  int32_t pressure_ = 0;  // the sum of the readings until known
  uint8_t readings_ = 0;
  uint8_t next_byte_ = 0;  // of the record, to be written
  bool recorded_ = false;  // in EEPROM, once all bytes are written
  bool uncertain_ = false;
};

}  // namespace mucat
