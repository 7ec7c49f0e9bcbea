"""Figures of roller profiles: the drop, downwards, along the roller."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from contactstudy import checks
from contactstudy.errors import InvalidInputError
from contactstudy.plots.style import LEGEND_WIDTH, fold_text, line_styles, new_axes
from contactstudy.profiles import Profile
from contactstudy.profiles.base import check_drop

if TYPE_CHECKING:
    from matplotlib.axes import Axes

POINTS = 4001


def plot_profile(
    profile: Profile, length: float, *, ax: Axes | None = None, deepest: float | None = None, **style: Any
) -> Axes:
    """Draw the generatrix of a roller, with the drop downwards.

    Parameters
    ----------
    profile : Profile
        Profile to draw.
    length : float
        Length of the roller, metres.
    ax : Axes, optional
        Axes to draw in; default: a new figure.
    deepest : float, optional
        Largest drop on the axis, metres; default: the profile's largest drop. Limit it for crowns of micrometres with
        fillets of tenths of a millimetre.
    **style
        Style of the line, as in matplotlib.

    Returns
    -------
    Axes
        The line ends where the drop is infinite.

    Raises
    ------
    InvalidInputError
        If `profile` is not a profile or does not fit the length, or a number is not positive.

    Examples
    --------
    >>> from contactstudy.profiles import Lundberg
    >>> plot_profile(Lundberg(amplitude=0.2e-6), length=10e-3).get_ylabel()
    'drop (µm)'
    """
    checks.instance("profile", profile, Profile, "a profile from contactstudy.profiles")
    length = checks.positive("length", length, "metres")
    x = 0.5 * length * np.linspace(-1, 1, POINTS)
    drop = check_drop(profile, x, length)
    drop = np.where(np.isfinite(drop), drop, np.nan)
    ax = new_axes(ax, (6.4, 3.2))
    ax.plot(1e3 * x, 1e6 * drop, **style)
    if not ax.yaxis_inverted():
        ax.invert_yaxis()
    if deepest is not None:
        deepest = checks.positive("deepest", deepest, "metres")
        ax.set_ylim(1e6 * deepest, -0.05e6 * deepest)
    ax.set_xlabel("distance from mid-length (mm)")
    ax.set_ylabel("drop (µm)")
    return ax


def plot_profiles(
    profiles: Mapping[str, Profile], length: float, *, ax: Axes | None = None, deepest: float | None = None
) -> Axes:
    """Compare the generatrices of rollers of one length.

    Parameters
    ----------
    profiles : mapping of str to Profile
        Profiles by their names in the legend.
    length : float
        Length of the rollers, metres.
    ax, deepest
        As for :func:`plot_profile`.

    Raises
    ------
    InvalidInputError
        If `profiles` is empty, or :func:`plot_profile` rejects an argument.

    Examples
    --------
    >>> from contactstudy.profiles import Cylinder, FullCrown
    >>> ax = plot_profiles({"sharp": Cylinder(), "crowned": FullCrown(1.0)}, length=10e-3)
    >>> [text.get_text() for text in ax.get_legend().get_texts()]
    ['sharp', 'crowned']
    """
    checks.instance("profiles", profiles, Mapping, "a mapping of names to profiles")
    if not profiles:
        raise InvalidInputError("profiles", dict(profiles), "at least one profile")
    for (name, profile), style in zip(profiles.items(), line_styles(len(profiles)), strict=True):
        ax = plot_profile(profile, length, ax=ax, deepest=deepest, label=fold_text(name, LEGEND_WIDTH), **style)
    assert ax is not None
    ax.legend(frameon=False, fontsize="small", ncols=2)
    return ax
