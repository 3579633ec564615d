"""Whitens residuals, so that each of them counts as much as it says.

Residuals of a channel are correlated in time: the encoders' errors shake the simulated hull, which forgets
that in a second. An autoregressive model of each channel (G. Yule, Phil. Trans. A 226, 1927; G. Walker, Proc.
R. Soc. A 131, 1931) predicts a residual from those just before it; what it cannot predict is white, and is
what counts in the fit (generalised least squares).
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_toeplitz

from robot_runtime.experiments.identification.bodies import Floats

ORDER = 4
"""Residuals before one from which it is predicted: 0.08 s."""
_LEAST = 1e-9


@dataclass(frozen=True, slots=True)
class Whitening:
    """The autoregressive model of each channel, and the standard deviation of what it leaves."""

    coefficients: Floats
    """Of shape (channels, ORDER), the newest residual first."""
    sigma: Floats
    """m, rad/s, m/s²."""

    @classmethod
    def of(cls, errors: Floats) -> "Whitening":
        """The model of residuals of shape (windows, channels, moments), by Yule and Walker."""
        moments = errors.shape[2]
        products = np.stack(
            [
                (errors[:, :, lag:] * errors[:, :, : moments - lag]).sum(axis=(0, 2))
                for lag in range(ORDER + 1)
            ]
        )
        # A share of white noise: a channel without any would leave the equations singular.
        products[0] = products[0] * (1 + 1e-6) + _LEAST**2
        coefficients = np.stack([solve_toeplitz(one[:ORDER], one[1:]) for one in products.T])
        white = cls(coefficients, np.ones(errors.shape[1])).apply(errors)
        return cls(coefficients, np.maximum(np.sqrt((white**2).mean(axis=(0, 2))), _LEAST))

    @classmethod
    def none(cls, sigma: Floats) -> "Whitening":
        """The model of residuals that are white, with these standard deviations."""
        return cls(np.zeros((len(sigma), ORDER)), sigma)

    def apply(self, errors: Floats) -> Floats:
        """Whitens along the third axis, to a standard deviation of 1; the first ORDER moments drop out.

        The axes are windows, channels, moments, and any more.
        """
        moments, more = errors.shape[2], (1,) * (errors.ndim - 3)
        found = errors[:, :, ORDER:].copy()
        for lag, share in enumerate(self.coefficients.T, 1):
            if share.any():
                found -= share.reshape(-1, 1, *more) * errors[:, :, ORDER - lag : moments - lag]
        found /= self.sigma.reshape(-1, 1, *more)
        return found
