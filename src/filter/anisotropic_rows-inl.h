// filter_row() for one target of the kernel source: included inside a namespace that has Float, Mask and the kernels.

PELAGE_LANES_FN float inverse_square(float sigma) { return std::isinf(sigma) ? 0 : 1 / (sigma * sigma); }

PELAGE_LANES_FN FilterKernel make_filter_kernel(const AnisotropicKernel& k) {
  const float major = std::fmax(0.5f, k.radius), minor = std::fmax(0.5f, k.radius * k.aspect);
  FilterKernel f;
  f.inverse_major2 = Float(inverse_square(major)), f.inverse_minor2 = Float(inverse_square(minor));
  f.inverse_distance2 = Float(inverse_square(major * k.sigma_distance));
  f.inverse_angle2 = Float(inverse_square(k.sigma_angle)), f.inverse_color2 = Float(inverse_square(k.sigma_color));
  f.half_inverse_along2 = Float(inverse_square(k.sigma_along) / 2);
  f.half_inverse_across2 = Float(inverse_square(k.sigma_across) / 2);
  return f;
}

/// Sums over the kernel of the pixels at p …, one a lane. kAngle, kExponent: whether the kernel has such terms at all.
template <bool kAngle, bool kExponent>
PELAGE_LANES_FN void filter_lanes(const FilterPlanes& planes, const FilterKernel& k, std::size_t p, std::size_t x,
                                  const FilterRow& out) {
  const Float tx = load(&planes.tangent_x[p]), ty = load(&planes.tangent_y[p]);
  const Vec3 here(load(&planes.r[p]), load(&planes.g[p]), load(&planes.b[p]));
  Float r(0.0f), g(0.0f), b(0.0f), alpha(0.0f), sum(0.0f);
  const int reach = planes.reach;
  for (int j = -reach; j <= reach; ++j) {
    const Float dy(static_cast<float>(j));
    const std::ptrdiff_t line = static_cast<std::ptrdiff_t>(p) + j * static_cast<std::ptrdiff_t>(planes.stride);
    for (int i = -reach; i <= reach; ++i) {
      const Float dx(static_cast<float>(i));
      const Float along = dx * tx + dy * ty, across = dx * ty - dy * tx;
      const Mask inside = filter_inside(k, along, across);
      if (!any(inside)) continue;
      const std::size_t q = static_cast<std::size_t>(line + i);
      const Vec3 color(load(&planes.r[q]), load(&planes.g[q]), load(&planes.b[q]));
      Float weight = select(inside, load(&planes.weight[q]), Float(0.0f));
      if (kExponent) {
        Float exponent = filter_distance_exponent(k, along, across) + filter_color_exponent(k, color - here);
        if (kAngle) exponent = exponent + v_square(filter_angle(along, across)) * k.inverse_angle2;
        weight = weight * m_exp(Float(0.0f) - exponent);
      }
      r = r + weight * color.x, g = g + weight * color.y, b = b + weight * color.z;
      alpha = alpha + weight * load(&planes.alpha[q]);
      sum = sum + weight;
    }
  }
  // A pixel without a tangent has a weight of 0 itself, and is left empty.
  const Mask hair = load(&planes.weight[p]) > Float(0.0f);
  const Float scale = select(hair, Float(1.0f) / select(hair, sum, Float(1.0f)), Float(0.0f));
  store(r * scale, out.r + x), store(g * scale, out.g + x), store(b * scale, out.b + x), store(alpha * scale, out.alpha + x);
}

template <bool kAngle, bool kExponent>
PELAGE_LANES_FN void filter_row_lanes(const FilterPlanes& planes, const FilterKernel& k, int y, const FilterRow& out) {
  const std::size_t row = planes.at(0, y), step = static_cast<std::size_t>(lanes());
  for (std::size_t x = 0; x < static_cast<std::size_t>(planes.width); x += step) {
    const Float zero(0.0f);
    if (any(load(&planes.weight[row + x]) > zero)) {
      filter_lanes<kAngle, kExponent>(planes, k, row + x, x, out);
    } else {
      for (float* plane : {out.r, out.g, out.b, out.alpha}) store(zero, plane + x);
    }
  }
}

PELAGE_LANES_FN void filter_row_any(const FilterPlanes& planes, const AnisotropicKernel& kernel, int y, const FilterRow& out) {
  const FilterKernel k = make_filter_kernel(kernel);
  const bool angle = !std::isinf(kernel.sigma_angle);
  const bool exponent = angle || !std::isinf(kernel.sigma_distance) || !std::isinf(kernel.sigma_color) ||
                        !std::isinf(kernel.sigma_along) || !std::isinf(kernel.sigma_across);
  if (angle) filter_row_lanes<true, true>(planes, k, y, out);
  else if (exponent) filter_row_lanes<false, true>(planes, k, y, out);
  else filter_row_lanes<false, false>(planes, k, y, out);
}
