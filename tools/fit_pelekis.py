#!/usr/bin/env python3
"""Fits the lobes of kernel/scatter/pelekis.h to the far field of Chiang 2016 and writes src/kernel/scatter/pelekis_fit.h.

usage: tools/fit_pelekis.py [--header FILE] [--check]

The truth is the mean of Chiang's near field over the offset across the fiber, by quadrature in double precision; nothing is read from
the kernel. Prints what every fit leaves; --check writes nothing and fails where the header is not what the fit gives within 1e-3.
Needs the Debian packages python3-numpy and python3-scipy. Derivation and residuals: docs/derivations/pelekis.md.
"""

import argparse
import pathlib
import re
import shutil
import subprocess
import sys

import numpy as np
from scipy.optimize import least_squares, minimize_scalar
from scipy.special import i0e

HEADER = pathlib.Path(__file__).resolve().parent.parent / "src/kernel/scatter/pelekis_fit.h"

# Where the lobes are fitted: cos(theta_o), eta, absorption per radius, azimuthal deviation in radians.
COSINES = np.linspace(0.05, 1, 20)
ETAS = np.array([1.3, 1.45, 1.55, 1.65, 1.8])
ABSORPTIONS = np.array([0.0, 0.1, 0.3, 1.0, 2.0])
BETA_N = np.array([0.175, 0.26, 0.5, 0.9])
ETA = 1.55  # where the polynomials in eta start from

# Gauss-Legendre in gamma_o = asin(h).
NODES, WEIGHTS = np.polynomial.legendre.leggauss(200)
GAMMA = (NODES + 1) * np.pi / 4
WEIGHTS = WEIGHTS * np.pi / 4 * np.cos(GAMMA)
H = np.sin(GAMMA)


def fresnel(cosine, eta):
    """Reflectance of a dielectric for unpolarized light."""
    inside = np.sqrt(1 - (1 - cosine * cosine) / eta**2)
    parallel = (eta * cosine - inside) / (eta * cosine + inside)
    perpendicular = (cosine - eta * inside) / (cosine + eta * inside)
    return 0.5 * (parallel**2 + perpendicular**2)


class Fiber:
    """Chiang's attenuations A_p(h) and exit azimuths at every node, for cos(theta_o), eta and sigma_a."""

    def __init__(self, c, eta, sigma):
        s2 = 1 - c * c
        self.inv_eta2 = c * c / (eta * eta - s2)
        self.x = 2 * sigma / np.sqrt(1 - s2 / eta**2)
        gamma_t = np.arcsin(H * np.sqrt(self.inv_eta2))
        f = fresnel(c * np.cos(GAMMA), eta)
        t = np.exp(-self.x * np.cos(gamma_t))
        self.r = f
        self.tt = (1 - f) ** 2 * t
        self.trt = self.tt * f * t
        self.rest = self.trt * f * t / (1 - f * t)
        self.phi_tt = 2 * (gamma_t - GAMMA)  # from phi = pi
        self.phi_trt = 4 * gamma_t - 2 * GAMMA

    def energies(self):
        return [float(a @ WEIGHTS) for a in (self.r, self.tt, self.trt, self.rest)]


def logistic(x, s):
    """Trimmed to [-pi, pi]."""
    e = np.exp(-np.abs(x) / s)
    return e / (s * (1 + e) ** 2 * np.tanh(np.pi / (2 * s)))


def wrap(x):
    return (x + np.pi) % (2 * np.pi) - np.pi


AZIMUTHS = (np.arange(180) + 0.5) / 180 * np.pi


def profile(energy, exits, beta_n):
    """Azimuthal distribution of a lobe over AZIMUTHS, integral over the circle 1."""
    weights = energy * WEIGHTS / (energy @ WEIGHTS)
    s = beta_n * np.sqrt(3) / np.pi
    around = [logistic(wrap(AZIMUTHS[:, None] - sign * exits[None, :]), s) @ weights for sign in (1, -1)]
    return 0.5 * (around[0] + around[1])


def ratio(p, c, u):
    """c (quadratic in c)/(1 + c), every coefficient linear in u."""
    q = [p[2 * i] + p[2 * i + 1] * u for i in range(4)]
    return np.clip(c * (q[0] + c * (q[1] + c * q[2])) / (1 + c * q[3]), 0, 1)


def plane(p, a, b):
    """Quadratic in a, each coefficient linear in b."""
    return (p[0] + p[1] * b) + a * ((p[2] + p[3] * b) + a * (p[4] + p[5] * b))


def pair(x, w, mu):
    """Two lobes 1/(z - b cos x)^4 at +mu and -mu; b = 1/w, z^2 = 1 + b^2."""
    b = 1 / w
    z = np.sqrt(1 + b * b)
    norm = 1 / (2 * np.pi * (5 * z * z - 3) * z)  # 1/(4 pi P_3(z))
    return norm * ((z - b * np.cos(x - mu)) ** -4 + (z - b * np.cos(x + mu)) ** -4)


def rms(x):
    return float(np.sqrt(np.mean(np.square(x))))


def relative(fit, truth):
    """RMS of the error over the RMS of the truth."""
    return rms(np.asarray(fit) - np.asarray(truth)) / rms(truth)


def fit_energies():
    """How much of the light enters, how much of that leaves as TT, how much of what is left leaves as TRT; no absorption."""
    grid = [(c, eta, Fiber(c, eta, 0.0).energies()) for c in COSINES for eta in ETAS]
    c, u = np.array([g[0] for g in grid]), np.array([g[1] - ETA for g in grid])
    r, tt, trt, rest = (np.array([g[2][i] for g in grid]) for i in range(4))
    targets = {"enter": 1 - r, "leave_tt": tt / (1 - r), "leave_trt": trt / (trt + rest)}
    fits = {}
    for name, y in targets.items():
        # Errors of what stays outside count relative to it: R is a few percent of the light.
        weight = 1 / np.maximum(1 - y, 0.05) if name == "enter" else 1.0
        start = np.array([5, -0.5, -2.5, 3.5, 1, -2, 3, 2.0])
        fits[name] = least_squares(lambda p, y=y, w=weight: (ratio(p, c, u) - y) * w, start, max_nfev=20000).x
    enter, leave_tt, leave_trt = (ratio(fits[n], c, u) for n in targets)
    inside = enter * (1 - leave_tt)
    print("energies without absorption, relative: R %.4f, TT %.4f, TRT %.4f, rest %.4f" %
          (relative(1 - enter, r), relative(enter * leave_tt, tt), relative(inside * leave_trt, trt),
           relative(inside * (1 - leave_trt), rest)))
    return fits


def transmittances(p, x, i, c):
    """What absorption leaves of TT, TRT and the rest: x = 2 sigma_a/cos(theta_t), i = 1/eta'^2."""
    t = np.exp(-x * (1 - p[0] * i))
    mirror = np.clip(p[3] + p[4] * c, 0, 1)
    return t, t * t * (1 + p[1] * x * i), t**3 * (1 + p[2] * x * i) * (1 - mirror) / (1 - mirror * t)


def fit_absorption():
    rows = []
    for c in COSINES:
        for eta in ETAS:
            clear = Fiber(c, eta, 0.0).energies()
            for sigma in ABSORPTIONS:
                f = Fiber(c, eta, sigma)
                rows.append((f.x, f.inv_eta2, c, *[a / b for a, b in zip(f.energies()[1:], clear[1:])], *clear[1:]))
    x, i, c, tt, trt, rest, e_tt, e_trt, e_rest = np.array(rows).T

    def error(p):
        a, b, d = transmittances(p, x, i, c)
        return np.concatenate([a - tt, b - trt, d - rest])

    p = least_squares(error, [0.2, 0.1, 0.1, 0.5, 0.0]).x
    a, b, d = transmittances(p, x, i, c)
    print("energies under absorption, relative: TT %.4f, TRT %.4f, rest %.4f" %
          (relative(a * e_tt, tt * e_tt), relative(b * e_trt, trt * e_trt), relative(d * e_rest, rest * e_rest)))
    return p


def quartic(p, a):
    return p[0] + a * (p[1] + a * (p[2] + a * (p[3] + a * p[4])))


def pair_shape(p, root, beta_n):
    """Width and offset of a pair, the offset as tan(mu); root = 1/eta': where the rays leave depends on nothing else, and on their energies little."""
    b2 = beta_n**2
    w = np.sqrt(np.maximum(quartic(p[:5], root), 0) + (p[5] + p[6] * root) * b2 + 1e-6)
    return w, np.arctan(np.sqrt(np.maximum(quartic(p[7:12], root), 0) + p[12] * b2))


def fit_pair(name):
    """One lobe's width^2 and offset^2 over (1/eta', beta_n), by the profiles themselves."""
    grid = [(Fiber(c, eta, sigma), beta_n) for c in COSINES[::2] for eta in ETAS[1:4] for sigma in (0.0, 0.3) for beta_n in BETA_N]
    truth = np.array([profile(f.tt, f.phi_tt, b) if name == "tt" else profile(f.trt, f.phi_trt, b) for f, b in grid])
    root, beta = np.array([(np.sqrt(f.inv_eta2), b) for f, b in grid]).T
    scale = 1 / np.sqrt(np.mean(truth**2, axis=1, keepdims=True))

    def profiles(p):
        w, mu = pair_shape(p, root, beta)
        return pair(AZIMUTHS[None, :], w[:, None], mu[:, None])

    start = np.r_[5.0, -6, 1, 0, 0, 5, 0, 0.3, -0.3, 0, 0, 0, 0.1]
    p = least_squares(lambda p: ((profiles(p) - truth) * scale).ravel(), start, max_nfev=400).x
    fit = profiles(p)
    misplaced = np.abs(fit - truth).sum(axis=1) * np.pi / AZIMUTHS.size
    print(f"{name.upper()} around the fiber: relative {rms((fit - truth) * scale):.4f}, energy elsewhere "
          f"mean {misplaced.mean():.4f}, at most {misplaced.max():.4f}")
    return p


def reflection(p, c, u, v_n):
    """Shares of the shoulder and the rim; they shrink as the blur grows."""
    return [np.clip(plane(q[:6], c, u) + v_n * (q[6] + q[7] * c), 0, 0.5) for q in (p[:8], p[8:])]


def reflection_profile(shoulder, rim):
    """N_R over AZIMUTHS: cos(phi/2)/4 (1 - s - r + 5 s h^4 + 17 r h^16), h = sin(phi/2), over A_R."""
    h = np.sin(AZIMUTHS / 2)
    return np.cos(AZIMUTHS / 2) / 4 * (1 - shoulder - rim + 5 * shoulder * h**4 + 17 * rim * h**16)


def fit_reflection():
    grid = [(Fiber(c, eta, 0.0), c, eta, b) for c in COSINES for eta in ETAS for b in BETA_N]
    truth = np.array([profile(f.r, 2 * GAMMA, b) for f, _, _, b in grid])
    c, eta, beta = (np.array([g[i] for g in grid]) for i in (1, 2, 3))

    def error(p):
        s, r = (a[:, None] for a in reflection(p, c, eta - ETA, beta**2))
        return reflection_profile(s, r) - truth

    start = np.array([0.1, 0, 0.5, 0, -0.3, 0, 0, 0, 0.1, 0, 0.3, 0, 0, 0, 0, 0])
    p = least_squares(lambda p: error(p).ravel(), start, max_nfev=300).x
    misplaced = np.abs(error(p)).sum(axis=1) * np.pi / AZIMUTHS.size
    s, r = reflection(p, c, eta - ETA, beta**2)
    print(f"R around the fiber: relative {rms(error(p)) / rms(truth):.4f}, energy elsewhere mean {misplaced.mean():.4f}, "
          f"at most {misplaced.max():.4f}, shares up to {(s + r).max():.3f}")
    return p


SINES = -1 + (np.arange(1000) + 0.5) / 500


def deon(theta, v):
    """d'Eon's M over SINES, for theta_o = theta, times d theta/d sine cos(theta_i)."""
    c = np.cos(theta)
    ci = np.sqrt(1 - SINES**2)
    norm = 1 / (v * (1 - np.exp(-2 / v)))
    return norm * i0e(ci * c / v) * np.exp(-0.5 / v * ((ci - c) ** 2 + (SINES + np.sin(theta)) ** 2))


def band_shape(p, sine, cosine, v):
    """Center over the sine and width of the logistic in sin(theta_i)."""
    y = 1 - cosine
    center = 1 + 2 * v * v / (v + p[0]) * (1 + y * (p[1] + p[2] * y))
    c2 = cosine * cosine
    return center, np.sqrt(p[3] * v * c2 + v * v * (1 - c2 * p[4] / (p[4] + v)))


def band(center, width):
    sigmoid = lambda t: 1 / (1 + np.exp(-np.clip(t, -80, 80)))
    e = np.exp(-np.clip(np.abs(SINES - center) / width, 0, 80))
    return e / (width * (1 + e) ** 2) / (sigmoid((1 - center) / width) - sigmoid((-1 - center) / width))


def fit_band():
    """The longitudinal lobe: a logistic in sin(theta_i), trimmed to [-1, 1]."""
    variances = np.array([0.002, 0.006, 0.02, 0.06, 0.15, 0.4, 1.0, 3.0])
    thetas = np.array([0.0, 0.3, 0.6, 0.9, 1.1, 1.25, 1.4])
    grid = [(t, v, deon(t, v)) for v in variances for t in thetas]

    def errors(p):
        out = []
        for t, v, truth in grid:
            center, width = band_shape(p, np.sin(t), np.cos(t), v)
            out.append((band(-np.sin(t) * center, width) - truth) / np.sqrt(np.mean(truth**2)))
        return out

    p = least_squares(lambda p: np.concatenate(errors(p)), [0.5, 0.8, 0.5, 0.37, 0.5], max_nfev=400).x
    misplaced = [np.abs(e * np.sqrt(np.mean(g[2] ** 2))).sum() / 1000 for e, g in zip(errors(p), grid)]
    print(f"along the fiber: relative {rms(np.concatenate(errors(p))):.4f}, energy elsewhere mean {np.mean(misplaced):.4f}, "
          f"at most {max(misplaced):.4f}")
    return p


def forward(p, w, mu):
    return 0.5 + np.arcsin(np.cos(mu) / (1 + p[0] * w * w)) / np.pi


def fit_forward():
    """Share of a pair's energy that goes on forward: 1 - E|x|/pi, x from phi = pi."""
    x = (np.arange(4000) + 0.5) / 4000 * np.pi
    w, mu = (a.ravel() for a in np.meshgrid([0.05, 0.1, 0.2, 0.4, 0.6, 0.9, 1.3, 2.0, 2.6], [0.0, 0.2, 0.4, 0.6]))
    share = np.array([1 - 2 * (pair(x, a, b) * x).sum() / 4000 for a, b in zip(w, mu)])
    p = least_squares(lambda p: forward(p, w, mu) - share, [0.1], bounds=(0, 10)).x
    print(f"share that goes forward: within {np.abs(forward(p, w, mu) - share).max():.4f}")
    return p


def rate(p, w):
    return p[0] / np.sqrt(1 + w * w * (p[1] + w * p[2]))


def fit_rate():
    """1/s of the logistic in y, tan(y/2) = (z + b) tan(x/2), that a lobe of a pair is drawn from: least greatest weight."""
    y = np.linspace(0, np.pi, 2000)[:-1]

    def worst(r, w):
        z = np.sqrt(1 + 1 / w**2)
        cosine = np.cos(2 * np.arctan(np.tan(y / 2) / (z + 1 / w)))
        lobe = 1 / (np.pi * (5 * z * z - 3) * z) / (z - cosine / w) ** 4
        return (lobe / (logistic(y, 1 / r) / (z - cosine / w))).max()

    w = np.array([0.02, 0.1, 0.3, 0.6, 1.0, 1.4, 1.8, 2.2, 2.6, 3.0, 4.0])
    best = np.array([minimize_scalar(lambda r, a=a: worst(r, a), bounds=(0.05, 6), method="bounded").x for a in w])
    p = least_squares(lambda p: rate(p, w) - best, [2.0, 0.3, 0.0], bounds=(0, 10)).x
    print(f"drawing a pair: largest weight {max(worst(r, a) for r, a in zip(rate(p, w), w)):.4f}, with the best rates "
          f"{max(worst(r, a) for r, a in zip(best, w)):.4f}")
    return p


class Lobes:
    """The fitted lobes as pelekis.h has them, for the residual of the whole."""

    def __init__(self, fits, c, eta, sigma, beta_m, beta_n):
        u = np.clip(eta - ETA, ETAS[0] - ETA, ETAS[-1] - ETA)
        f = Fiber(c, eta, sigma)
        enter, leave_tt, leave_trt = (ratio(fits[n], c, u) for n in ("enter", "leave_tt", "leave_trt"))
        t = transmittances(fits["absorption"], f.x, f.inv_eta2, c)
        inside = enter * (1 - leave_tt)
        self.energies = [1 - enter, enter * leave_tt * t[0], inside * leave_trt * t[1], inside * (1 - leave_trt) * t[2]]
        root = np.sqrt(f.inv_eta2)
        self.around = [reflection_profile(*reflection(fits["reflection"], c, u, beta_n**2)),
                       pair(np.pi - AZIMUTHS, *pair_shape(fits["tt"], root, beta_n)),
                       pair(AZIMUTHS, *pair_shape(fits["trt"], root, beta_n)), np.full(AZIMUTHS.size, 0.5 / np.pi)]
        sine = np.sqrt(1 - c * c)
        self.along = []
        for v in (4 * beta_m**2, beta_m**2, 16 * beta_m**2, 16 * beta_m**2):
            center, width = band_shape(fits["band"], sine, c, v)
            self.along.append(band(-sine * center, width))


class Truth:
    """The mean of Chiang's near field over the offset, without tilt."""

    def __init__(self, c, eta, sigma, beta_m, beta_n):
        f = Fiber(c, eta, sigma)
        self.energies = f.energies()
        self.around = [profile(f.r, 2 * GAMMA, beta_n), profile(f.tt, f.phi_tt + np.pi, beta_n),
                       profile(f.trt, f.phi_trt, beta_n), np.full(AZIMUTHS.size, 0.5 / np.pi)]
        theta = np.arccos(c)
        self.along = [deon(theta, v) for v in (4 * beta_m**2, beta_m**2, 16 * beta_m**2, 16 * beta_m**2)]


def measure(fits):
    """What all fits together leave of f cos(theta_i), lobe by lobe and in all."""
    squares = np.zeros((5, 2))
    elsewhere = []
    for c in (0.3, 0.6, 0.85, 1.0):
        for eta in (1.45, 1.55, 1.65):
            for sigma in (0.0, 0.3, 2.0):
                for beta_m in (0.06, 0.13, 0.25):
                    for beta_n in (0.175, 0.26, 0.6):
                        fit, truth = Lobes(fits, c, eta, sigma, beta_m, beta_n), Truth(c, eta, sigma, beta_m, beta_n)
                        pairs = [[e * m[:, None] * n[None, :] for e, m, n in zip(x.energies, x.along, x.around)] for x in (fit, truth)]
                        for x in pairs:
                            x.append(sum(x))
                        scale = np.mean(pairs[1][4] ** 2)  # bright and wide fibers count alike
                        for i in range(5):
                            squares[i] += [np.mean((pairs[0][i] - pairs[1][i]) ** 2) / scale, np.mean(pairs[1][i] ** 2) / scale]
                        elsewhere.append(0.5 * np.abs(pairs[0][4] - pairs[1][4]).sum() / pairs[1][4].sum())
    left = np.sqrt(squares[:, 0] / squares[:, 1])
    print("f cos(theta_i), relative: R %.3f, TT %.3f, TRT %.3f, rest %.3f, in all %.3f" % tuple(left))
    print(f"energy elsewhere: mean {np.mean(elsewhere):.4f}, at most {max(elsewhere):.4f}")


def number(x):
    """Six digits, with a point: a literal of C++ and of GLSL."""
    text = f"{x:.6g}"
    return text if "." in text or "e" in text else text + ".0"


def literal(x):
    return f"Float({number(x)}f)"


def linear(a, b, variable):
    """a + b variable."""
    return f"{literal(a)} {'+' if b >= 0 else '-'} {literal(abs(b))} * {variable}"


def ratio_code(name, p, what):
    q = [linear(p[2 * i], p[2 * i + 1], "u") for i in range(4)]
    return (f"// {what}\nPELAGE_FN Float scatter_pelekis_{name}(Float c, Float u) {{\n"
            f"  Float a = ({q[1]}) + c * ({q[2]});\n"
            f"  return v_clamp(c * (({q[0]}) + c * a) / (Float(1.0f) + c * ({q[3]})), Float(0.0f), Float(1.0f));\n}}\n")


def plane_code(name, p):
    q = [linear(p[2 * i], p[2 * i + 1], "u") for i in range(3)]
    return (f"PELAGE_FN Float scatter_pelekis_{name}(Float c, Float u, Float v_n) {{\n"
            f"  Float sharp = ({q[0]}) + c * (({q[1]}) + c * ({q[2]}));\n"
            f"  return v_clamp(sharp + v_n * ({linear(p[6], p[7], 'c')}), Float(0.0f), Float(0.5f));\n}}\n")


def quartic_code(name, p, blur):
    lines = [f"  Float p = {literal(p[4])};"]
    lines += [f"  p = p * root {'+' if a >= 0 else '-'} {literal(abs(a))};" for a in reversed(p[:4])]
    return (f"PELAGE_FN Float scatter_pelekis_{name}(Float root, Float v_n) {{\n" + "\n".join(lines) +
            f"\n  return max(p, Float(0.0f)) + {blur} * v_n;\n}}\n")


def header(fits):
    a, b, tt, trt, r = (fits[n] for n in ("absorption", "band", "tt", "trt", "reflection"))
    constants = {
        "kPelekisEta": ETA, "kPelekisEtaRange": ETAS[-1] - ETA, "kPelekisMaxRoot": 1 / ETAS[0],
        "kPelekisChordTt": a[0], "kPelekisChordTrt": a[1], "kPelekisChordRest": a[2],
        "kPelekisBandRise": b[0], "kPelekisBandSlope": b[1], "kPelekisBandCurve": b[2], "kPelekisBandNear": b[3],
        "kPelekisBandFar": b[4], "kPelekisForward": fits["forward"][0], "kPelekisRate": fits["rate"][0],
        "kPelekisRateFall": fits["rate"][1], "kPelekisRateWide": fits["rate"][2]}
    text = """// Made by tools/fit_pelekis.py: the numbers of pelekis.h, fitted to the mean of Chiang's near field over the fiber.
// Derivation and residuals: docs/derivations/pelekis.md. c = cos(theta_o), u = eta - kPelekisEta, root = 1/eta' (Bravais).

"""
    text += "".join(f"const float {k} = {number(v)}f;\n" for k, v in constants.items()) + "\n"
    text += ratio_code("enter", fits["enter"], "Share of the light that enters the fiber.")
    text += ratio_code("leave_tt", fits["leave_tt"], "Share of what has entered that leaves as TT, nothing being absorbed.")
    text += ratio_code("leave_trt", fits["leave_trt"], "Share of what is left then that leaves as TRT.")
    text += (f"// Mean reflectance inside of what leaves after TRT.\nPELAGE_FN Float scatter_pelekis_mirror(Float c) {{\n"
             f"  return v_clamp({linear(a[3], a[4], 'c')}, Float(0.0f), Float(1.0f));\n}}\n")
    text += "// Shares of N_R that its shoulder and its rim have.\n" + plane_code("shoulder", r[:8]) + plane_code("rim", r[8:])
    text += "// Width^2 and tan^2(mu) of the pairs; v_n: variance of the azimuthal blur, radians^2.\n"
    for name, p in (("tt", tt), ("trt", trt)):
        text += quartic_code(f"width2_{name}", p[:5], f"({linear(p[5], p[6], 'root')})")
        text += quartic_code(f"tan2_{name}", p[7:12], literal(p[12]))
    return text


def numbers(text):
    return np.array([float(x) for x in re.findall(r"-?\d+\.\d+(?:e[-+]?\d+)?(?=f)", text)])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--header", type=pathlib.Path, default=HEADER)
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    fits = fit_energies()
    fits.update(absorption=fit_absorption(), reflection=fit_reflection(), tt=fit_pair("tt"), trt=fit_pair("trt"),
                band=fit_band(), forward=fit_forward(), rate=fit_rate())
    measure(fits)
    text = header(fits)
    if options.check:
        old, new = numbers(options.header.read_text()), numbers(text)
        if old.size != new.size or not np.allclose(old, new, rtol=1e-3, atol=1e-3):
            sys.exit(f"{options.header} is not what the fit gives")
        return
    options.header.write_text(text)
    formatter = shutil.which("clang-format")
    if formatter:
        subprocess.run([formatter, "-i", options.header], check=True)


if __name__ == "__main__":
    main()
