#pragma once

#include "perception/types/types.h"

namespace loci::perception::types {

/// How a native C++ type is kept in a CAS. Specialised per native type (geometry.h here;
/// perception/conversions for OpenCV, PCL and cameras; anybody for types of their own) with
///
///     using Proxy = ...;                                      what it is kept as
///     static Proxy to(cas::Cas& cas, const Native& value);
///     static Native from(const Proxy& proxy);                 throws Error when the proxy is null or does
///     not fit
///
/// so that the meaning of what is stored is written down in one place.
template <typename Native>
struct Conversion;

/// Keeps a native value in a CAS: `types::Mat mat = types::to(cas, image)`.
template <typename Native>
typename Conversion<Native>::Proxy to(cas::Cas& cas, const Native& value) {
  return Conversion<Native>::to(cas, value);
}

/// Brings it back: `cv::Mat image = types::from<cv::Mat>(mat)`. Throws Error when `proxy` is null.
template <typename Native>
Native from(const typename Conversion<Native>::Proxy& proxy) {
  if (!proxy) throw Error("no " + std::string(Conversion<Native>::Proxy::kTypeName) + " to convert");
  return Conversion<Native>::from(proxy);
}

}  // namespace loci::perception::types
