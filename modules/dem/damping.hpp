// The damping that gives a contact its coefficient of restitution e, whatever the speed of the impact.
//
//   Hertz   F = k δ^(3/2) + α √(m k) δ^(1/4) dδ/dt     [Y. Tsuji, T. Tanaka, T. Ishida, Powder Technol. 71, 239 (1992)]
//   Hooke   F = k δ + α √(m k) dδ/dt
//
// m is the reduced mass of the pair. In units of the largest overlap without damping and of the time that it takes to
// get there, e follows from α alone. Dry grains do not pull: the contact ends where F falls to 0, before δ does. α is
// the root of e(α) for this end [C. Thornton, S. J. Cummins, P. W. Cleary, Powder Technol. 233, 30 (2013)].
#pragma once

namespace tetsuame::dem {

enum class contact_model { hertz_mindlin, hooke };

// e of a head-on impact with this α, in [0, 1].
double restitution_of(contact_model model, double alpha);
// α of that e, in (0, 1].
double damping_for(contact_model model, double restitution);

}  // namespace tetsuame::dem
