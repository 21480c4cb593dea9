#pragma once
// A lattice as the bytes that stores keep of it.

#include <cmath>

#include "core/lattice.h"
#include "stream/store/bytes.h"

namespace pss {

/// `Writer` is a ByteWriter, or does as one.
template <class Writer>
void put_lattice(Writer& w, const Lattice& lattice) {
  for (const double s : lattice.scale) w.put(s);
  for (const double o : lattice.origin) w.put(o);
}

/// Fails the reader where a scale is not above 0, or anything is not finite.
inline Lattice get_lattice(ByteReader& r) {
  Lattice lattice;
  for (double& s : lattice.scale) s = r.get<double>();
  for (double& o : lattice.origin) o = r.get<double>();
  for (const double s : lattice.scale)
    if (!(s > 0) || !std::isfinite(s)) r.fail();
  for (const double o : lattice.origin)
    if (!std::isfinite(o)) r.fail();
  return lattice;
}

}  // namespace pss
