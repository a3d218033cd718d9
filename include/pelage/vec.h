// Small vectors, std430-friendly: plain floats, no padding, no invariants.
#pragma once

#include <cmath>

namespace pelage {

struct Vec2 {
  float x = 0, y = 0;
  constexpr Vec2() = default;
  constexpr Vec2(float px, float py) : x(px), y(py) {}
};
struct Vec3 {
  float x = 0, y = 0, z = 0;
  constexpr Vec3() = default;
  constexpr Vec3(float px, float py, float pz) : x(px), y(py), z(pz) {}
};
struct Vec4 {
  float x = 0, y = 0, z = 0, w = 0;
  constexpr Vec4() = default;
  constexpr Vec4(float px, float py, float pz, float pw) : x(px), y(py), z(pz), w(pw) {}
};

inline constexpr bool operator==(Vec2 a, Vec2 b) { return a.x == b.x && a.y == b.y; }
inline constexpr bool operator==(Vec3 a, Vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
inline constexpr bool operator==(Vec4 a, Vec4 b) { return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w; }

inline constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
inline constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
inline constexpr Vec2 operator*(Vec2 a, float s) { return {a.x * s, a.y * s}; }
inline constexpr Vec2 operator*(float s, Vec2 a) { return a * s; }

inline constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
inline constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline constexpr Vec3 operator*(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline constexpr Vec3 operator*(Vec3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline constexpr Vec3 operator*(float s, Vec3 a) { return a * s; }
inline constexpr Vec3 operator/(Vec3 a, Vec3 b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }
inline constexpr Vec3 operator/(Vec3 a, float s) { return {a.x / s, a.y / s, a.z / s}; }
inline constexpr Vec3& operator+=(Vec3& a, Vec3 b) { return a = a + b; }
inline constexpr Vec3& operator-=(Vec3& a, Vec3 b) { return a = a - b; }
inline constexpr Vec3& operator*=(Vec3& a, float s) { return a = a * s; }

inline constexpr float dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
inline constexpr float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline constexpr Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline float length(Vec2 a) { return std::sqrt(dot(a, a)); }
inline float length(Vec3 a) { return std::sqrt(dot(a, a)); }
/// Unit vector along `a`; the zero vector stays zero (callers that cannot have one test before).
inline Vec3 normalize(Vec3 a) {
  const float l = length(a);
  return l > 0 ? a / l : a;
}
inline constexpr Vec3 lerp(Vec3 a, Vec3 b, float t) { return a + (b - a) * t; }
inline Vec3 min(Vec3 a, Vec3 b) { return {std::fmin(a.x, b.x), std::fmin(a.y, b.y), std::fmin(a.z, b.z)}; }
inline Vec3 max(Vec3 a, Vec3 b) { return {std::fmax(a.x, b.x), std::fmax(a.y, b.y), std::fmax(a.z, b.z)}; }
inline bool is_finite(Vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/// Affine map p ↦ rows·(p, 1): three rows of four.
struct Affine {
  float m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
};
inline Vec3 transform_point(const Affine& a, Vec3 p) {
  const auto row = [&](int i) { return a.m[i][0] * p.x + a.m[i][1] * p.y + a.m[i][2] * p.z + a.m[i][3]; };
  return {row(0), row(1), row(2)};
}
inline Vec3 transform_vector(const Affine& a, Vec3 v) {
  const auto row = [&](int i) { return a.m[i][0] * v.x + a.m[i][1] * v.y + a.m[i][2] * v.z; };
  return {row(0), row(1), row(2)};
}

/// Axis-aligned box; empty (lower > upper) by default.
struct Bounds {
  Vec3 lower{INFINITY, INFINITY, INFINITY};
  Vec3 upper{-INFINITY, -INFINITY, -INFINITY};
  void extend(Vec3 p) { lower = min(lower, p), upper = max(upper, p); }
  void extend(const Bounds& b) { lower = min(lower, b.lower), upper = max(upper, b.upper); }
  bool empty() const { return !(lower.x <= upper.x); }
  Vec3 center() const { return (lower + upper) * 0.5f; }
  Vec3 extent() const { return upper - lower; }
};

}  // namespace pelage
