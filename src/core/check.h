// PELAGE_CHECK: programmer errors, told with both values. Aborts in debug builds, throws std::logic_error in release.
// Bad input is no programmer error: see pelage::Error.
#pragma once

#include <fmt/format.h>

#include <cstdlib>
#include <stdexcept>

namespace pelage::detail {

[[noreturn]] inline void check_failed(const std::string& message) {
#ifdef NDEBUG
  throw std::logic_error(message);
#else
  fmt::print(stderr, "{}\n", message);
  std::abort();
#endif
}

template <class A, class B>
[[noreturn]] void check_op_failed(const char* file, int line, const char* text, const A& a, const B& b) {
  check_failed(fmt::format("{}:{}: check failed: {} (left {}, right {})", file, line, text, a, b));
}

}  // namespace pelage::detail

#define PELAGE_CHECK(condition)                                                                                               \
  do {                                                                                                                        \
    if (!(condition)) ::pelage::detail::check_failed(fmt::format("{}:{}: check failed: {}", __FILE__, __LINE__, #condition)); \
  } while (false)
#define PELAGE_CHECK_OP(a, op, b)                                                                                              \
  do {                                                                                                                         \
    const auto& pelage_a = (a);                                                                                                \
    const auto& pelage_b = (b);                                                                                                \
    if (!(pelage_a op pelage_b)) ::pelage::detail::check_op_failed(__FILE__, __LINE__, #a " " #op " " #b, pelage_a, pelage_b); \
  } while (false)
#define PELAGE_CHECK_EQ(a, b) PELAGE_CHECK_OP(a, ==, b)
#define PELAGE_CHECK_LE(a, b) PELAGE_CHECK_OP(a, <=, b)
#define PELAGE_CHECK_LT(a, b) PELAGE_CHECK_OP(a, <, b)
