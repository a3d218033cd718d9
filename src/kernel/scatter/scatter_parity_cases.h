// Every scattering function on one set of inputs; included inside the namespace of each target that is compared.
// get(k) is the k-th input, uniform in [0, 1); put(v) takes the next output.

constexpr std::size_t kParityInputs = 17;
constexpr std::size_t kParityOutputs = 61;

template <class Get, class Put>
void scatter_parity_cases(Get get, Put put) {
  const auto put3 = [&](Vec3 v) { put(v.x), put(v.y), put(v.z); };
  const auto put4 = [&](ScatterPair n) { put(n.kappa), put(n.cos_mu), put(n.sin_mu), put(n.norm); };
  const auto range = [&](std::size_t k, float lo, float hi) { return Float(lo) + get(k) * Float(hi - lo); };
  const Vec3 color(get(0), get(1), get(2));
  const Float beta_n = range(3, 1e-3f, 1.2f);
  put3(scatter_melanin(range(4, 0, 8), range(5, 0, 3)));
  put3(scatter_absorption(color, beta_n));
  put3(scatter_tuft_color(color, beta_n));
  const Vec3 sigma_a = scatter_absorption(color, beta_n) + scatter_melanin(get(4), get(5));
  const ScatterFiber f =
      scatter_fiber(range(6, 1.2f, 2.2f), range(7, 5e-4f, 0.6f), beta_n, range(8, -0.09f, 0.09f), range(9, 0, 2), sigma_a);
  const Float theta_o = range(10, -1.5707963f, 1.5707963f);
  const Float theta_i = range(11, -1.5707963f, 1.5707963f);
  const Float sin_o = m_sin(theta_o), cos_o = m_cos(theta_o);
  const Float sin_i = m_sin(theta_i), cos_i = abs(m_cos(theta_i));
  const Float cos_phi = range(12, -1, 1);
  const ScatterLobes l = scatter_prepare_marschner(f, sin_o, cos_o);
  const ScatterLobes z = scatter_prepare_zhu(f, sin_o, cos_o);
  put(l.a_r), put3(l.a_tt), put3(l.a_trt), put3(l.a_rest), put4(l.n_tt), put4(l.n_trt), put4(z.n_tt);
  put(l.front_r), put(l.front_tt), put(l.front_trt);
  put3(scatter_marschner(l, sin_i, cos_i, cos_phi));
  put3(scatter_zhu(z, sin_i, cos_i, cos_phi));
  put3(scatter_kajiya_kay(l, color, sin_i, cos_i));
  const ScatterAverages a = scatter_averages(l);
  put3(a.a_f), put3(a.a_b);
  const ScatterBack b = scatter_back(a, l);
  put3(b.a), put(b.cone.v), put(b.cone.shift);
  const Float n = range(13, 0, 30);
  put(scatter_dual_direct(n)), put(scatter_dual_transmittance(n, a.a_f).x);
  const Float v = scatter_dual_variance(n, a.v_f) * get(14);
  put(scatter_dual_forward_marschner(l, v, sin_i, cos_i, cos_phi).x);
  put(scatter_dual_forward_zhu(z, v, sin_i, cos_i, cos_phi).y);
  put(scatter_dual_local(b, v, sin_i, cos_i, cos_phi).z);
  put(scatter_i0e(range(15, 0, 40))), put(scatter_fresnel(get(16), f.eta));
}
