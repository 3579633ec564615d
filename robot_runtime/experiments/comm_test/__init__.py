"""The communication test: numbers over the serial line, cell by cell of a grid of bauds and delays.

`document` reads a test, `builder` compiles its sketch, `framings` is the host's end of the line without I/O,
`runner` runs the cells on the emulated board, `results` says what they mean.
"""
