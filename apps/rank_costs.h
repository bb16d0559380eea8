#pragma once
#include "apps/ranks.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace apps {

/// What a rank has spent since a look: processor time [s], and its cells.
struct RankTime {
  double points; ///< beyond what all points take alike
  double rest;   ///< with the time in which it waited for others
  double n_cells;
};

/// What a cell takes apart from what its points take of their own, alike on all ranks [s]: the
/// least over the ranks, as the others have also waited.
double common_cost(std::span<const RankTime> ranks);

/// What it would have saved to have the ranks' costs differ by another ratio of largest to mean.
/// \param waited  largest less mean cost [s]
/// \param now     largest over mean cost that this came from [-]
double saving(double waited, double now, double then);

/// What the cells of a rank cost while a body is computed, measured as processor time, and how
/// equal that is over the ranks. All ranks do all of it together.
class RankCosts {
public:
  /// Starts anew with other cells.
  /// \param price  what it costs to share them out [s]; the largest of the ranks counts
  void begin(double price, const Ranks& ranks);

  /// Whether some rank has spent so much since the last look that a sharing could be worth it.
  bool is_due(std::span<const double> points, const Ranks& ranks) const;

  /// Takes the costs of the points of this rank since `begin`.
  void look(std::span<const double> points, std::size_t n_cells, const Ranks& ranks);

  /// Of each cell of this rank; what was before the last looks counts half for each of them [s].
  const std::vector<double>& of_cells() const { return of_cells_; }
  double imbalance() const;                 ///< of these costs: largest over mean of the ranks [-]
  double waited() const { return waited_; } ///< largest less mean, all since `begin` [s]
  double price() const { return price_; }   ///< [s]

  /// Notes that the cells are about to be shared out anew.
  void count_sharing();

  /// One line for users.
  std::string summary() const;

private:
  std::vector<double> of_cells_, of_ranks_; ///< of the last looks
  std::vector<double> all_of_ranks_;        ///< since `begin`
  std::vector<double> seen_;                ///< of the points, at the last look
  double clock_ = 0, waited_ = 0, price_ = 0;
  long n_sharings_ = 0;
  double before_ = 1; ///< imbalance before the first sharing
};

} // namespace apps
