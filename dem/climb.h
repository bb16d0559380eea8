#pragma once
#include "dem/events.h"
#include "dem/quasistatic.h"

namespace dem {

/// The state of the event solver at a time between its last change and the next, as one from which
/// the quasi-static solver goes on: positions, rotations, what each mode of each bond remembers,
/// the history of the strain for the rate law, and the breakages. Nothing is replayed.
///
/// Pairs without a bond, which the event solver does not see, begin to touch where they are: those
/// that came into each other carry nothing at first.
///
/// The forces are in equilibrium on the geometry of the start; the new solver begins by seeking
/// equilibrium on that of now, and its energy ledger counts from here.
QuasistaticState climb(const QuasistaticModel& model, const EventsModel& from,
                       const EventsSolver& solver, const EventsState& state, double time);

} // namespace dem
