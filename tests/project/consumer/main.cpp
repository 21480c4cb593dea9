// A program outside the project: the installed headers and libraries are all that it has.
#include "core/lattice.h"
#include "stream/memory.h"

int main() {
  const pss::Lattice lattice = pss::lattice_for({.min = {0, 0, 0}, .max = {1, 1, 1}});
  return pss::on_lattice(lattice, {0.5, 0.5, 0.5}) && pss::machine_memory() > 0 ? 0 : 1;
}
