// The library as a sketch sees it.
#pragma once
#include "robot.h"
