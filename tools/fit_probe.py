#!/usr/bin/env python3
"""Fits the roughness of a GGX lobe to the length of its mean direction: the numbers of kernel/scatter/glow.h.

usage: tools/fit_probe.py

The lobe is the one that prefiltered maps have, light by D(h) cos over its axis with normal, view and axis alike (Walter 2007 for D).
Prints the coefficients and what the fit leaves. Needs the Debian packages python3-numpy and python3-scipy.
Derivation: docs/derivations/probe.md.
"""

import numpy as np
from scipy.optimize import least_squares


def mean_cosine(alpha):
    cosine = (np.arange(20000) + 0.5) / 20000
    half = (1 + cosine) / 2  # cos^2 of the half vector
    weight = cosine / (1 - (1 - alpha**2) * half) ** 2
    return (weight * cosine).sum() / weight.sum()


def main():
    alpha = np.linspace(0.08, 1, 60)
    short = 1 - np.array([mean_cosine(a) for a in alpha])
    model = lambda p: short * (p[0] + short * (p[1] + short * p[2]))
    p = least_squares(lambda p: model(p) / alpha - 1, [2.3, -6, 24]).x
    print("alpha = x (%.5g %+.5g x %+.5g x^2), x = 1 - mean cosine; relative error at most %.3f" %
          (*p, np.abs(model(p) / alpha - 1).max()))
    print("mean cosine at alpha = 1: %.5f" % mean_cosine(1.0))


if __name__ == "__main__":
    main()
