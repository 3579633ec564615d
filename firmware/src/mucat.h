// The header that a sketch includes.
#pragma once
#include "robot.h"
