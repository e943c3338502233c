#pragma once

#include <algorithm>
#include <cmath>

namespace tetsuame::elements {

// Metal and silicate of these masses that hold so much of an element.
struct holders {
  double element, metal, silicate;  // of any unit; kg, kg
  // Of the metal where all is in equilibrium with the partition coefficient P, amount per mass.
  double concentration(double P) const { return element / (metal + silicate / P); }
};

// Of what the metal takes up from its start to equilibrium with all silicate: the part taken at concentration c; 1
// where it has nothing to take up.
inline double equilibration(const holders& all, double start, double c, double P) {
  const double there = all.concentration(P);
  if (std::abs(there - start) <= 1e-12 * std::max(there, start)) return 1.0;
  return (c - start) / (there - start);
}

}  // namespace tetsuame::elements
