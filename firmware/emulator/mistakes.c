// SPDX-License-Identifier: GPL-3.0-or-later
#include "mistakes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WRONG_BRIDGE_ADDRESS 0x62
#define WRONG_IMU_ADDRESS 0x68
#define DEGREE (M_PI / 180)

const char mistakes_usage[] =
    "  motors-swapped:FIN,FIN     each of two motors is at the other's H-bridge\n"
    "  leads-reversed:FIN         a motor's leads are swapped\n"
    "  encoders-swapped:FIN,FIN   each of two encoders is at the other's select\n"
    "  encoder-reversed:FIN       a magnet lies the wrong way round: its encoder counts backwards\n"
    "  strap-wrong:FIN            an H-bridge is at 0x62\n"
    "  strap-shared:FIN,FIN       the first's H-bridge has the second's address\n"
    "  imu-strap                  the IMU is at 0x68\n"
    "  imu-turned:AXES            the body axes along which the IMU's lie; +x-y-z is upside down\n"
    "  imu-clone:IDENTITY         WHO_AM_I of another chip, 1 to 255\n"
    "  missing:PART               imu, pressure, battery, beacon-right, beacon-left, motor-FIN, bridge-FIN "
    "or\n"
    "                             encoder-FIN is not connected\n"
    "  beacons-inverted           low is heard\n"
    "  beacons-swapped            right is left\n"
    "  divider-wrong:FACTOR       the battery reads as this many times its voltage, 0.1 to 10\n"
    "  regulator-off:PERCENT      the 5 V are this much higher, -10 to 10\n"
    "  gyro-offset:X,Y,Z          of the gyroscope's axes, -20 to 20 degrees/s\n"
    "  gyro-drift:X,Y,Z           of the gyroscope's offsets, -1 to 1 degrees/s for each degree C above 25\n"
    "  encoder-noise:TICKS        of all encoders, to either side, 0 to 20\n"
    "  backlash:RAD               of all fins' gears, 0 to 0.3\n"
    "  stiction:STEPS             of all fins: below this drive one that rests stays at rest, 0 to 63\n"
    "  pack-resistance:OHM        of the battery, 0 to 2\n"
    "FIN is front-right, back-right, back-left or front-left.\n";

static const char *const fin_names[FIN_COUNT] = {"front-right", "back-right", "back-left", "front-left"};

// The fin of this name, or -1.
static int fin_of(const char *name) {
  for (int fin = 0; fin < FIN_COUNT; fin++) {
    if (!strcmp(name, fin_names[fin])) {
      return fin;
    }
  }
  return -1;
}

static bool two_fins(const char *text, int fins[2]) {
  char first[16];
  const char *comma = strchr(text, ',');
  size_t length = comma ? (size_t)(comma - text) : sizeof first;
  if (length >= sizeof first) {
    return false;
  }
  memcpy(first, text, length);
  first[length] = 0;
  fins[0] = fin_of(first);
  fins[1] = fin_of(comma + 1);
  return fins[0] >= 0 && fins[1] >= 0 && fins[0] != fins[1];
}

// Exactly `count` numbers with commas between them.
static bool numbers(const char *text, double *values, int count, double least, double most) {
  for (int i = 0; i < count; i++) {
    char *end;
    values[i] = strtod(text, &end);
    char after = i + 1 < count ? ',' : 0;
    if (end == text || *end != after || !(values[i] >= least && values[i] <= most)) {
      return false;
    }
    text = end + 1;
  }
  return true;
}

static bool swap(int values[FIN_COUNT], const char *fins) {
  int fin[2];
  if (!two_fins(fins, fin)) {
    return false;
  }
  int first = values[fin[0]];
  values[fin[0]] = values[fin[1]];
  values[fin[1]] = first;
  return true;
}

static bool reverse(int signs[FIN_COUNT], const char *name) {
  int fin = fin_of(name);
  if (fin >= 0) {
    signs[fin] = -1;
  }
  return fin >= 0;
}

static bool swap_motors(struct wiring *wiring, const char *fins) { return swap(wiring->bridge, fins); }

static bool reverse_leads(struct wiring *wiring, const char *fin) { return reverse(wiring->leads, fin); }

static bool swap_encoders(struct wiring *wiring, const char *fins) { return swap(wiring->shaft, fins); }

static bool reverse_encoder(struct wiring *wiring, const char *fin) { return reverse(wiring->counting, fin); }

static bool strap_wrong(struct wiring *wiring, const char *name) {
  int fin = fin_of(name);
  if (fin >= 0) {
    wiring->bridge_address[fin] = WRONG_BRIDGE_ADDRESS;
  }
  return fin >= 0;
}

static bool share_strap(struct wiring *wiring, const char *fins) {
  int fin[2];
  bool valid = two_fins(fins, fin);
  if (valid) {
    wiring->bridge_address[fin[0]] = wiring->bridge_address[fin[1]];
  }
  return valid;
}

static bool strap_imu(struct wiring *wiring, const char *nothing) {
  wiring->imu_address = WRONG_IMU_ADDRESS;
  return !*nothing;
}

static bool turn_imu(struct wiring *wiring, const char *text) {
  struct chip_axis axes[3];
  int matrix[3][3] = {{0}};
  if (strlen(text) != 6) {
    return false;
  }
  for (int i = 0; i < 3; i++) {
    char sign = text[2 * i], axis = text[2 * i + 1];
    if ((sign != '+' && sign != '-') || axis < 'x' || axis > 'z') {
      return false;
    }
    axes[i] = (struct chip_axis){axis - 'x', sign == '+' ? 1 : -1};
    matrix[i][axes[i].body] = axes[i].sign;
  }
  int determinant = 0;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    determinant += matrix[0][i] * (matrix[1][j] * matrix[2][k] - matrix[1][k] * matrix[2][j]);
  }
  if (determinant != 1) {
    return false;  // an axis twice, or a mirror image, as no chip can lie
  }
  memcpy(wiring->imu_axes, axes, sizeof axes);
  return true;
}

static bool clone_imu(struct wiring *wiring, const char *text) {
  char *end;
  unsigned long identity = strtoul(text, &end, 0);
  bool valid = *text >= '0' && *text <= '9' && !*end && identity >= 1 && identity <= 255;
  if (valid) {
    wiring->imu_identity = (uint8_t)identity;
  }
  return valid;
}

// A part of a fin, such as `motor-front-left`: the fin, or -1.
static int fin_of_part(const char *part, const char *kind) {
  size_t length = strlen(kind);
  return strncmp(part, kind, length) || part[length] != '-' ? -1 : fin_of(part + length + 1);
}

static bool disconnect(struct wiring *wiring, const char *part) {
  int motor = fin_of_part(part, "motor"), bridge = fin_of_part(part, "bridge");
  int encoder = fin_of_part(part, "encoder");
  if (!strcmp(part, "imu")) {
    wiring->imu_address = NO_ADDRESS;
  } else if (!strcmp(part, "pressure")) {
    wiring->pressure_address = NO_ADDRESS;
  } else if (!strcmp(part, "battery")) {
    wiring->divider = INFINITY;
  } else if (!strcmp(part, "beacon-right") || !strcmp(part, "beacon-left")) {
    wiring->beacon_connected[!strcmp(part, "beacon-left")] = false;
  } else if (motor >= 0) {
    wiring->bridge[motor] = NOT_CONNECTED;
  } else if (bridge >= 0) {
    wiring->bridge_address[bridge] = NO_ADDRESS;
  } else if (encoder >= 0) {
    wiring->shaft[encoder] = NOT_CONNECTED;
  } else {
    return false;
  }
  return true;
}

static bool invert_beacons(struct wiring *wiring, const char *nothing) {
  wiring->beacons_inverted = true;
  return !*nothing;
}

static bool swap_beacons(struct wiring *wiring, const char *nothing) {
  wiring->beacons_swapped = true;
  return !*nothing;
}

static bool set_divider(struct wiring *wiring, const char *text) {
  double factor;
  bool valid = numbers(text, &factor, 1, 0.1, 10);
  if (valid) {
    wiring->divider /= factor;
  }
  return valid;
}

static bool set_regulator(struct wiring *wiring, const char *text) {
  double percent;
  bool valid = numbers(text, &percent, 1, -10, 10);
  if (valid) {
    wiring->reference = 5 * (1 + percent / 100);
  }
  return valid;
}

// Three numbers of the gyroscope's axes, in degrees.
static bool set_gyro(double values[3], const char *text, double most) {
  double degrees[3];
  bool valid = numbers(text, degrees, 3, -most, most);
  for (int axis = 0; valid && axis < 3; axis++) {
    values[axis] = degrees[axis] * DEGREE;
  }
  return valid;
}

static bool set_gyro_offset(struct wiring *wiring, const char *text) {
  return set_gyro(wiring->gyro_offset, text, 20);
}

static bool set_gyro_drift(struct wiring *wiring, const char *text) {
  return set_gyro(wiring->gyro_drift, text, 1);
}

static bool set_encoder_noise(struct wiring *wiring, const char *text) {
  return numbers(text, &wiring->encoder_noise, 1, 0, 20);
}

static bool set_backlash(struct wiring *wiring, const char *text) {
  return numbers(text, &wiring->backlash, 1, 0, 0.3);
}

static bool set_stiction(struct wiring *wiring, const char *text) {
  return numbers(text, &wiring->stiction, 1, 0, 63);
}

static bool set_pack_resistance(struct wiring *wiring, const char *text) {
  return numbers(text, &wiring->pack_resistance, 1, 0, 2);
}

static const struct {
  const char *name;
  bool (*apply)(struct wiring *wiring, const char *argument);
} mistakes[] = {
    {"motors-swapped", swap_motors},
    {"leads-reversed", reverse_leads},
    {"encoders-swapped", swap_encoders},
    {"encoder-reversed", reverse_encoder},
    {"strap-wrong", strap_wrong},
    {"strap-shared", share_strap},
    {"imu-strap", strap_imu},
    {"imu-turned", turn_imu},
    {"imu-clone", clone_imu},
    {"missing", disconnect},
    {"beacons-inverted", invert_beacons},
    {"beacons-swapped", swap_beacons},
    {"divider-wrong", set_divider},
    {"regulator-off", set_regulator},
    {"gyro-offset", set_gyro_offset},
    {"gyro-drift", set_gyro_drift},
    {"encoder-noise", set_encoder_noise},
    {"backlash", set_backlash},
    {"stiction", set_stiction},
    {"pack-resistance", set_pack_resistance},
};

bool mistakes_add(struct wiring *wiring, const char *text) {
  const char *colon = strchr(text, ':');
  size_t length = colon ? (size_t)(colon - text) : strlen(text);
  struct wiring changed = *wiring;
  for (unsigned i = 0; i < sizeof mistakes / sizeof *mistakes; i++) {
    if (strlen(mistakes[i].name) == length && !strncmp(text, mistakes[i].name, length)) {
      // A name without an argument has no colon either.
      bool valid = mistakes[i].apply(&changed, colon ? colon + 1 : "") && !(colon && !colon[1]);
      if (valid) {
        *wiring = changed;
      }
      return valid;
    }
  }
  return false;
}
