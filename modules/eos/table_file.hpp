// Tables of pressure and energy by density and temperature, as text, in the two forms in which planetary tables are
// handed round (docs/theory/eos_tables.md):
//
//   SWIFT and WoMa        lines of a head (a date on one of its own); number of densities, of temperatures; the
//   densities
//                         in kg/m^3; the temperatures in K; then for each temperature, for each density a line of
//                         u (J/kg), p (Pa), c (m/s), s (J/(K kg))
//   SESAME, as ANEOS      records INDEX, 201 and 301, five numbers a line; 301 holds the two numbers, the densities in
//   writes it             g/cm^3, the temperatures in K, then p in GPa, u in MJ/kg and, if it likes, the free energy,
//   for
//                         each temperature by density
//
// A first density or temperature of 0 has no place on logarithmic axes, and is left out. UTF-8 with a byte order mark
// or without, lines that end with LF, CRLF or CR. All errors are of status bad_input, with file and line.
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

namespace tetsuame::eos {

struct table_data {
  std::string title;           // the first line of its head
  std::vector<double> rho, T;  // kg/m^3, K: ascending, above 0, two of each at least
  std::vector<double> p, u;    // Pa, J/kg: [temperature * rho.size() + density], finite
  std::vector<double> c, s;    // m/s, J/(K kg), likewise: of a table to be written; nothing is read into them
};

table_data read_table(const std::string& path);
// name: what messages call the text.
table_data parse_table(std::string_view text, const std::string& name);

// In SWIFT's form, with a first density and temperature of 0, which its readers leave out whatever stands there.
void write_table(std::ostream& out, const table_data& table);

}  // namespace tetsuame::eos
