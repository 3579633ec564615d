// The test document's values as macros. These defaults are for a sketch that is uploaded by hand.
#pragma once

#ifndef COMM_TEST_BAUD
#define COMM_TEST_BAUD 9600
#endif
#ifndef COMM_TEST_ARDUINO_DELAY  // s after every message
#define COMM_TEST_ARDUINO_DELAY 0.0
#endif
#ifndef COMM_TEST_FROM
#define COMM_TEST_FROM 1
#endif
#ifndef COMM_TEST_TO  // the number after the last one
#define COMM_TEST_TO 101
#endif

#define COMM_TEST_PLAIN 0
#define COMM_TEST_THESIS 1
#define COMM_TEST_ROBOT 2
#ifndef COMM_TEST_FRAMING
#define COMM_TEST_FRAMING COMM_TEST_THESIS
#endif

#define COMM_TEST_TO_BOARD 1
#define COMM_TEST_TO_HOST 2
#define COMM_TEST_BOTH (COMM_TEST_TO_BOARD | COMM_TEST_TO_HOST)
#ifndef COMM_TEST_DIRECTION
#define COMM_TEST_DIRECTION COMM_TEST_TO_BOARD
#endif
