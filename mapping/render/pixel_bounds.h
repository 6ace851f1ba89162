#pragma once

namespace loci::mapping::render_detail {

/// Pixels from first to last, both included.
struct PixelBox {
  int u_first, u_last, v_first, v_last;

  bool empty() const { return u_first > u_last || v_first > v_last; }
  int area() const { return (u_last - u_first + 1) * (v_last - v_first + 1); }
};

/// Smallest integer >= x, clamped to [low, high + 1]; std::ceil is a call on plain x86-64.
inline int first_pixel(double x, int low, int high) {
  if (!(x > low)) return low;
  if (x > high) return high + 1;
  const int i = static_cast<int>(x);
  return i + (i < x ? 1 : 0);
}

/// Largest integer <= x, clamped to [low - 1, high].
inline int last_pixel(double x, int low, int high) {
  if (!(x < high)) return high;
  if (x < low) return low - 1;
  return static_cast<int>(x);
}

}  // namespace loci::mapping::render_detail
