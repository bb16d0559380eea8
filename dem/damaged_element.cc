#include "dem/damaged_element.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace dem {

namespace {

constexpr double force_noise = 1e-12;
constexpr double contact_noise = 1e-10;
constexpr double most_ground_share = 1e-8;

struct Held {
  Pieces pieces;
  std::vector<Pin> pins;
};

std::vector<bool> touched_by_contacts(const MacroNetwork& macro, const Pieces& pieces)
{
  std::vector<bool> touched(pieces.hold.size(), false);
  for (std::size_t b = 0; b < macro.status.size(); ++b)
    if (macro.status[b] == BondStatus::pressed) {
      const auto [i, j] = macro.network.bonds[b].ends;
      if (pieces.piece[i] != pieces.piece[j])
        touched[pieces.piece[i]] = touched[pieces.piece[j]] = true;
    }
  return touched;
}

/// How the clusters of intact bonds are held: what goes on for ever by the mean strain, once its
/// rigid motion is pinned; what only contacts touch by weak springs; the rest is loose.
Held held_clusters(const VolumeElement& element, const MacroNetwork& macro)
{
  std::vector<BondStatus> bonded = macro.status;
  std::ranges::replace(bonded, BondStatus::pressed, BondStatus::gone);
  Clusters clusters = find_clusters(element, bonded);
  Held result{{std::vector<int>(element.particles.size()), {}, true}, {}};
  for (std::size_t c = 0; c < clusters.cluster.size(); ++c)
    for (const Index i : clusters.cluster[c].particles)
      result.pieces.piece[i] = int(c);
  result.pieces.hold.resize(clusters.cluster.size());
  const std::vector<bool> touched = touched_by_contacts(macro, result.pieces);
  bool has_pin = false;
  Clusters pinned;
  for (std::size_t c = 0; c < clusters.cluster.size(); ++c) {
    const Cluster& cluster = clusters.cluster[c];
    const bool endless = !cluster.direction.empty();
    const bool pin = endless && (!touched[c] || !has_pin);
    result.pieces.hold[c] = pin          ? PieceHold::held
                            : touched[c] ? PieceHold::clamped
                                         : PieceHold::loose;
    has_pin = has_pin || pin;
    if (pin)
      pinned.cluster.push_back(cluster);
  }
  result.pins = rigid_motion_pins(pinned, macro.network);
  return result;
}

/// Energies of the weak springs over the volume, per product of two unit strains [Pa].
Mat6 ground_energy(const MacroNetwork& macro, const Pieces& pieces, const Eigen::MatrixXd& dofs)
{
  const double spring = relative_ground_stiffness * mean_normal_stiffness(macro.network);
  Mat6 energy = Mat6::Zero();
  for (std::size_t i = 0; i < pieces.piece.size(); ++i)
    if (pieces.of(Index(i)) == PieceHold::clamped) {
      const auto rows = dofs.middleRows<6>(macro.network.first_dof[i]);
      energy += spring / macro.volume * rows.transpose() * rows;
    }
  return energy;
}

/// Forces of all bonds and the stiffness of the element, from the motion under unit strains.
void measure(const MacroNetwork& macro, const Pieces& pieces, const Eigen::MatrixXd& dofs,
             DamagedElement& result)
{
  Mat6 energy = Mat6::Zero();
  result.force.setZero(3 * Eigen::Index(macro.bonds.size()), 6);
  for (std::size_t b = 0; b < macro.bonds.size(); ++b) {
    const Index end = macro.network.bonds[b].ends[0];
    if (macro.status[b] == BondStatus::gone || pieces.of(end) == PieceHold::loose)
      continue;
    const Mat6 deformation =
        macro.bonds[b].strain + macro.bonds[b].motion * end_motion(macro, b, dofs);
    const Vec6 stiffness = carried_stiffness(macro, b, macro.law_stiffness);
    energy += deformation.transpose() * stiffness.asDiagonal() * deformation;
    result.force.middleRows<3>(3 * Eigen::Index(b)) =
        stiffness.head<3>().asDiagonal() * deformation.topRows<3>();
  }
  result.stiffness = energy / macro.volume;
}

struct Forces {
  Eigen::VectorXd components; ///< normal and two shear of each bond [N]
  double noise;               ///< what counts as nothing [N]
};

Forces forces(const DamagedElement& element, const Vec6& strain, double noise)
{
  Forces result{element.force * strain, 0};
  if (result.components.size() > 0)
    result.noise = noise * result.components.cwiseAbs().maxCoeff();
  return result;
}

CriticalBond judged(const Forces& forces, const Strengths& strengths, std::size_t b)
{
  const auto at = 3 * Eigen::Index(b);
  const double normal = forces.components[at];
  const double shear = std::hypot(forces.components[at + 1], forces.components[at + 2]);
  const double by_tension = normal > forces.noise ? normal / strengths.normal[b] : 0;
  const double by_shear = shear > forces.noise ? shear / strengths.shear[b] : 0;
  return {Index(b), by_tension >= by_shear ? BreakMode::tension : BreakMode::shear, normal, shear,
          std::max(by_tension, by_shear)};
}

CreepLaw shared_law(const VolumeElement& element)
{
  if (!element.is_periodic)
    throw std::invalid_argument("a volume element that breaks must be periodic");
  const auto laws = proportional_laws(element.laws);
  if (!laws)
    throw std::invalid_argument("volume elements that break need bond laws that are proportional "
                                "to each other: one function of time for all bonds");
  return laws->creep;
}

} // namespace

BreakableElement::BreakableElement(VolumeElement element, Strengths strengths,
                                   AfterBreakage after_breakage)
    : element_(std::move(element)), strengths_(std::move(strengths)),
      after_breakage_(after_breakage), creep_(shared_law(element_)),
      macro_(make_macro_network(element_))
{
  if (after_breakage == AfterBreakage::friction)
    throw std::invalid_argument("volume elements that break know no friction: broken bonds leave, "
                                "or stay as pressed contacts without friction");
  if (strengths_.normal.size() != n_bonds() || strengths_.shear.size() != n_bonds())
    throw std::invalid_argument(
        "each bond of a volume element needs a normal and a shear strength");
  intact_ = answer(macro_.status);
}

std::unique_ptr<MacroSolver> BreakableElement::borrowed_solver() const
{
  const std::scoped_lock guard(lock_);
  if (idle_.empty())
    return std::make_unique<MacroSolver>(macro_);
  std::unique_ptr<MacroSolver> solver = std::move(idle_.back());
  idle_.pop_back();
  return solver;
}

std::shared_ptr<const DamagedElement> BreakableElement::answer(std::vector<BondStatus> status) const
{
  MacroNetwork macro = macro_;
  macro.status = status;
  const Held held = held_clusters(element_, macro);
  auto result = std::make_shared<DamagedElement>();
  result->n_broken = std::size_t(
      std::ranges::count_if(status, [](BondStatus each) { return each != BondStatus::intact; }));
  result->has_contacts = std::ranges::find(status, BondStatus::pressed) != status.end();
  std::unique_ptr<MacroSolver> solver = borrowed_solver();
  Eigen::MatrixXd dofs;
  if (solver->factorise(macro, held.pins, held.pieces, macro.law_stiffness)) {
    const Eigen::MatrixXd loads = strain_loads(macro, macro.law_stiffness);
    const bool weakly_held = std::ranges::find(held.pieces.hold, PieceHold::clamped) !=
                             held.pieces.hold.end(); // then the first solution may lose digits
    dofs = weakly_held ? -solver->solve(loads) : -solver->solve_once(loads);
  } else {
    result->obstacle = "the remaining bonds and contacts of a volume element are a mechanism";
    std::ranges::fill(macro.status, BondStatus::gone); // carries nothing
    dofs = Eigen::MatrixXd::Zero(macro.n_dofs(), 6);
  }
  {
    const std::scoped_lock guard(lock_);
    idle_.push_back(std::move(solver));
  }
  measure(macro, held.pieces, dofs, *result);
  result->ground_energy = ground_energy(macro, held.pieces, dofs);
  result->is_clamped.resize(status.size());
  for (std::size_t b = 0; b < status.size(); ++b)
    result->is_clamped[b] = std::ranges::any_of(macro.network.bonds[b].ends, [&](Index i) {
      return held.pieces.of(i) == PieceHold::clamped;
    });
  for (std::size_t b = 0; b < status.size(); ++b)
    result->reach.push_back(std::max(result->force.row(3 * Eigen::Index(b)).norm(),
                                     std::numeric_limits<double>::min()));
  result->status = std::move(status);
  return result;
}

namespace {

double largest_ratio(const DamagedElement& element, const Strengths& strengths,
                     const Eigen::VectorXd& components)
{
  const double noise = components.size() > 0 ? force_noise * components.cwiseAbs().maxCoeff() : 0;
  const double* force = components.data();
  double tension = 0, shear_square = 0;
  for (std::size_t b = 0; b < element.status.size(); ++b, force += 3) {
    if (element.status[b] != BondStatus::intact)
      continue;
    if (force[0] > noise)
      tension = std::max(tension, force[0] / strengths.normal[b]);
    if (const double square = force[1] * force[1] + force[2] * force[2]; square > noise * noise)
      shear_square = std::max(shear_square, square / (strengths.shear[b] * strengths.shear[b]));
  }
  return std::max(tension, std::sqrt(shear_square));
}

/// What opens pressed contacts under an elastic strain.
struct Opening {
  double noise;      ///< largest pull that counts as nothing [N]
  bool squeezed_out; ///< whether contacts of pieces that weak springs hold open, too
};

Opening opening(const DamagedElement& element, const Eigen::VectorXd& force, const Vec6& strain)
{
  return {contact_noise * force.cwiseAbs().maxCoeff(),
          strain.dot(element.ground_energy * strain) >
              most_ground_share * std::abs(strain.dot(element.stiffness * strain))};
}

bool opens(const DamagedElement& element, std::size_t contact, double normal,
           const Opening& opening)
{
  return normal > opening.noise || (opening.squeezed_out && element.is_clamped[contact]);
}

} // namespace

double largest_ratio(const DamagedElement& element, const Strengths& strengths, const Vec6& strain)
{
  return largest_ratio(element, strengths, Eigen::VectorXd(element.force * strain));
}

Look look_at(const DamagedElement& element, const Strengths& strengths, const Vec6& strain)
{
  const Eigen::VectorXd force = element.force * strain;
  Look look{largest_ratio(element, strengths, force), std::numeric_limits<double>::infinity()};
  if (!element.has_contacts)
    return look;
  const Opening rule = opening(element, force, strain);
  for (std::size_t b = 0; b < element.status.size(); ++b)
    if (element.status[b] == BondStatus::pressed) {
      const double normal = force[3 * Eigen::Index(b)];
      if (opens(element, b, normal, rule)) {
        look.opening_margin = -1;
        break;
      }
      // a clamped one may also open by what is squeezed out
      const double margin = element.is_clamped[b] ? 0 : std::max(0., -normal / element.reach[b]);
      look.opening_margin = std::min(look.opening_margin, margin);
    }
  return look;
}

std::vector<CriticalBond> bonds_from(const DamagedElement& element, const Strengths& strengths,
                                     const Vec6& strain, double ratio)
{
  const Forces under = forces(element, strain, force_noise);
  std::vector<CriticalBond> result;
  for (std::size_t b = 0; b < element.status.size(); ++b)
    if (element.status[b] == BondStatus::intact)
      if (const CriticalBond bond = judged(under, strengths, b);
          bond.ratio > 0 && bond.ratio >= ratio)
        result.push_back(bond);
  return result;
}

std::vector<BondStatus> with_broken(const DamagedElement& element, AfterBreakage after_breakage,
                                    std::span<const CriticalBond> broken)
{
  std::vector<BondStatus> status = element.status;
  for (const CriticalBond& each : broken)
    status[each.bond] = after_breakage == AfterBreakage::pressed && each.normal_force < 0
                            ? BondStatus::pressed
                            : BondStatus::gone;
  return status;
}

std::vector<Index> contacts_to_open(const DamagedElement& element, const Vec6& strain)
{
  if (!element.has_contacts)
    return {};
  const Eigen::VectorXd force = element.force * strain;
  const Opening rule = opening(element, force, strain);
  std::vector<Index> result;
  for (std::size_t b = 0; b < element.status.size(); ++b)
    if (element.status[b] == BondStatus::pressed &&
        opens(element, b, force[3 * Eigen::Index(b)], rule))
      result.push_back(Index(b));
  return result;
}

double share_until_opening(const DamagedElement& element, const Vec6& from, const Vec6& to)
{
  double share = 1;
  if (!element.has_contacts)
    return share;
  const Forces before = forces(element, from, contact_noise);
  const Forces after = forces(element, to, contact_noise);
  for (std::size_t b = 0; b < element.status.size(); ++b) {
    const double a = before.components[3 * Eigen::Index(b)];
    const double z = after.components[3 * Eigen::Index(b)];
    if (element.status[b] == BondStatus::pressed && z > after.noise && a < z)
      share = std::min(share, std::max(0., -a / (z - a)));
  }
  return share;
}

} // namespace dem
