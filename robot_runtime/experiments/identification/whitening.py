"""Whitening of residuals, so that each counts by its accuracy.

The encoders' errors move the simulated hull more, the faster the fins are; while the robot drifts with its
fins at rest, the residuals of turn rates are a tenth as large. So each channel's variance is a sum: a fixed
part, and one in proportion to the fins' mean square speed.

Residuals of a channel are correlated in time: the encoders' errors shake the simulated hull, which forgets
that in a second. An autoregressive model of each channel (G. Yule, Phil. Trans. A 226, 1927; G. Walker, Proc.
R. Soc. A 131, 1931) predicts a residual from those just before it; what it cannot predict is white, and is
what counts in the fit (generalised least squares).
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_toeplitz
from scipy.optimize import nnls

from robot_runtime.experiments.identification.bodies import Floats

ORDER = 4
"""Residuals before one from which it is predicted: 0.08 s."""
_PARTS = 12
"""Of equal size, from the least activity of the fins to the most, in which mean squares are taken."""
_LEAST = 1e-9


@dataclass(frozen=True, slots=True)
class Whitening:
    """The autoregressive model of each channel, and the standard deviations of its innovations."""

    coefficients: Floats
    """Of shape (channels, ORDER), the newest residual first."""
    sigma: Floats
    """m, rad/s, m/s², of shape (windows, channels, moments), or 1 where all are alike."""

    @classmethod
    def of(cls, errors: Floats, activity: Floats) -> "Whitening":
        """Return the model of residuals of shape (windows, channels, moments), by Yule and Walker.

        `activity` is the fins' mean square speed (rad²/s²), of shape (windows, moments).
        """
        moments = errors.shape[2]
        products = np.stack(
            [
                (errors[:, :, lag:] * errors[:, :, : moments - lag]).sum(axis=(0, 2))
                for lag in range(ORDER + 1)
            ]
        )
        # A share of white noise: a channel without any would leave the equations singular.
        products[0] = products[0] * (1 + 1e-6) + _LEAST**2
        coefficients = np.stack([solve_toeplitz(product[:ORDER], product[1:]) for product in products.T])
        white = cls.none(np.ones(errors.shape[1]), coefficients).apply(errors)
        later = activity[:, ORDER:]
        sigma = np.stack([_deviations(channel, later) for channel in white.transpose(1, 0, 2)], axis=1)
        return cls(coefficients, sigma)

    @classmethod
    def none(cls, sigma: Floats, coefficients: Floats | None = None) -> "Whitening":
        """Return the model of white residuals with these standard deviations at all times."""
        if coefficients is None:
            coefficients = np.zeros((len(sigma), ORDER))
        return cls(coefficients, sigma[None, :, None])

    def apply(self, errors: Floats) -> Floats:
        """Whiten along the third axis, to a standard deviation of 1; the first ORDER moments drop out.

        The axes are windows, channels, moments, and any more.
        """
        moments, more = errors.shape[2], (1,) * (errors.ndim - 3)
        whitened = errors[:, :, ORDER:].copy()
        for lag, share in enumerate(self.coefficients.T, 1):
            if share.any():
                whitened -= share.reshape(-1, 1, *more) * errors[:, :, ORDER - lag : moments - lag]
        whitened /= self.sigma.reshape(*self.sigma.shape, *more)
        return whitened


def _deviations(white: Floats, activity: Floats) -> Floats:
    """Return the standard deviation of each of a channel's residuals, of shape (windows, moments)."""
    parts = np.array_split(np.argsort(activity, axis=None), _PARTS)
    squares = np.array([max((white.ravel()[part] ** 2).mean(), _LEAST**2) for part in parts])
    terms = np.array([(1.0, activity.ravel()[part].mean()) for part in parts])
    # Of each part's mean square the relative error counts.
    (fixed, growing), _ = nnls(terms / squares[:, None], np.ones(_PARTS))
    # No moment counts more than the quietest part shows.
    known = np.maximum(activity, terms[0, 1])
    return np.asarray(np.maximum(np.sqrt(fixed + growing * known), _LEAST))
