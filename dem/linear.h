#pragma once
#include "dem/events.h"

#include <complex>

namespace dem {

/// An intact specimen with proportional laws and small displacements: one elastic solution answers
/// for all times and frequencies.
struct LinearModel {
  ElasticNetwork network;
  CreepLaw creep; ///< the law with K_m = 1: creep_compliance is j(t) = J(t) / J(0)
  std::vector<RelaxationMode> spectrum;
  Eigen::VectorXd unit_response; ///< dofs per unit of the load factor, elastic
  double compliance;             ///< elastic displacement at the load per force [m/N]
  double area, gauge_length;
  NetworkSolver::Statistics statistics; ///< of the elastic solution
};

/// Solves the network once.
/// \throws std::invalid_argument if the laws are not proportional, std::runtime_error if the
///         network cannot carry the load
/// \param most_factored  particles from which on it iterates
LinearModel make_linear_model(const Assembly& assembly,
                              std::size_t most_factored = most_factored_particles_once);

/// D(t) [1/Pa]: strain per nominal stress applied at t = 0.
double creep_compliance(const LinearModel& model, double t);

/// E* = E' + i E'' [Pa] at an angular frequency [rad/s].
std::complex<double> complex_modulus(const LinearModel& model, double omega);

/// The same for a creep law with K_m = 1 and an elastic D(0) [1/Pa].
std::complex<double> complex_modulus(const CreepLaw& creep, double elastic, double omega);

/// Force and displacement at the load at a time under any loading, by superposition of the steps
/// and ramps before it. Nothing is stored between times. For true stress see the event solver.
struct LinearResponse {
  double force;        ///< [N], or load factor
  double displacement; ///< [m]
};
LinearResponse linear_response(const LinearModel& model, const Loading& loading, double time);

/// The same for many times: load and displacement from breakpoint to breakpoint, once for all.
/// \throws std::invalid_argument for true stress
LoadHistory linear_history(const LinearModel& model, const Loading& loading);

/// Displacements of all dofs at a time.
Eigen::VectorXd displacements(const LinearModel& model, const Loading& loading, double time);

/// Elastic displacements at a time: they give the bond forces.
Eigen::VectorXd elastic_displacements(const LinearModel& model, const Loading& loading,
                                      double time);

} // namespace dem
