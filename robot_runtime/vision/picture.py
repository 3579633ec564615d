"""A picture in memory."""

import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.uint8]
