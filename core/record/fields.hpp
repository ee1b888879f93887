/// \file
/// Every single fact of a record with its name, unit and meaning, once: the journal's JSON, the
/// HDF5 writer and the HDF5 reader all walk these tables.
///
///     for_each_field(header.tester, [](const FieldName& name, auto& value) { … });
///
/// Values are strings (empty = not known), numbers, optional numbers or vectors of double.
#pragma once

#include <concepts>
#include <string_view>
#include <type_traits>

#include "core/record/record.hpp"

namespace stickslip::record {

struct FieldName {
  std::string_view name;
  std::string_view unit;       ///< SI, "1" for a ratio, a number or a count; empty for text.
  std::string_view long_name;  ///< With the unit, for axes; empty for text.
};

/// `const Facts` or `Facts`: each table serves reading and writing.
template <typename T, typename Facts>
concept FieldsOf = std::same_as<std::remove_const_t<T>, Facts>;

template <FieldsOf<TesterFacts> Facts, typename Visitor>
void for_each_field(Facts& facts, Visitor&& visit) {
  visit(FieldName{"sled_mass", "kg", "mass of the sled [kg]"}, facts.sled_mass_kg);
  visit(FieldName{"gravity", "m/s^2", "acceleration of gravity [m/s^2]"}, facts.gravity_m_per_s2);
  visit(FieldName{"pull_speed", "m/s", "nominal pull speed [m/s]"}, facts.pull_speed_m_per_s);
  visit(FieldName{"stiffness", "N/m", "stiffness of the coupling [N/m]"}, facts.stiffness_N_per_m);
  visit(FieldName{"speed_course", "", ""}, facts.speed_course);
}

template <FieldsOf<CalibrationFacts> Facts, typename Visitor>
void for_each_field(Facts& facts, Visitor&& visit) {
  visit(FieldName{"date", "", ""}, facts.date);
  visit(FieldName{"certificate", "", ""}, facts.certificate);
  visit(FieldName{"gain_standard_error", "N/V", "standard error of the load cell gain [N/V]"},
        facts.gain_standard_error_N_per_V);
}

template <FieldsOf<daq::LoadCell> Facts, typename Visitor>
void for_each_field(Facts& facts, Visitor&& visit) {
  visit(FieldName{"gain", "N/V", "force per voltage of the load cell [N/V]"}, facts.gain_N_per_V);
  visit(FieldName{"zero", "V", "voltage at no force [V]"}, facts.zero_V);
}

template <FieldsOf<SampleFacts> Facts, typename Visitor>
void for_each_field(Facts& facts, Visitor&& visit) {
  visit(FieldName{"name", "", ""}, facts.name);
  visit(FieldName{"grade", "", ""}, facts.grade);
  visit(FieldName{"direction", "", ""}, facts.direction);
  visit(FieldName{"side", "", ""}, facts.side);
  visit(FieldName{"replicate", "1", "number of the replicate, from 1 [1]"}, facts.replicate);
}

template <FieldsOf<ProcessFacts> Facts, typename Visitor>
void for_each_field(Facts& facts, Visitor&& visit) {
  visit(FieldName{"program", "", ""}, facts.program);
  visit(FieldName{"version", "", ""}, facts.version);
  visit(FieldName{"commit", "", ""}, facts.commit);
  visit(FieldName{"configuration", "", ""}, facts.configuration);
  visit(FieldName{"estimator", "", ""}, facts.estimator);
  visit(FieldName{"method", "", ""}, facts.method);
  visit(FieldName{"characterisation", "", ""}, facts.characterisation);
  visit(FieldName{"realtime", "", ""}, facts.realtime);
  visit(FieldName{"simulation", "", ""}, facts.simulation);
}

/// The second channel, but what it measures: that has to be known before.
template <FieldsOf<daq::SecondChannel> Channel, typename Visitor>
void for_each_field(Channel& channel, Visitor&& visit) {
  const bool speed = channel.quantity == daq::SecondQuantity::kPullSpeed;
  visit(FieldName{"channel", "1", "number of the channel [1]"}, channel.channel);
  visit(FieldName{"maxdata", "1", "largest code [1]"}, channel.maxdata);
  visit(FieldName{"range_min", "V", "lower end of the input range [V]"}, channel.range_min_V);
  visit(FieldName{"range_max", "V", "upper end of the input range [V]"}, channel.range_max_V);
  visit(FieldName{"polynomial", "V", "voltage by ascending powers of (code - expansion_origin) [V]"},
        channel.polynomial);
  visit(FieldName{"expansion_origin", "1", "origin of the polynomial, a code [1]"}, channel.expansion_origin);
  visit(FieldName{"calibration", "", ""}, channel.calibration);
  visit(speed ? FieldName{"gain", "m/s/V", "speed per voltage [m/s/V]"}
              : FieldName{"gain", "m/V", "distance per voltage [m/V]"},
        channel.gain_per_V);
  visit(FieldName{"zero", "V", "voltage at rest or at the origin [V]"}, channel.zero_V);
}

/// What the input is called.
template <FieldsOf<daq::BoardInfo> Info, typename Visitor>
void for_each_name_field(Info& board, Visitor&& visit) {
  visit(FieldName{"driver", "", ""}, board.driver);
  visit(FieldName{"board", "", ""}, board.board_name);
  visit(FieldName{"device", "", ""}, board.device);
}

/// The converter; meaningless for imported values.
template <FieldsOf<daq::BoardInfo> Info, typename Visitor>
void for_each_converter_field(Info& board, Visitor&& visit) {
  visit(FieldName{"subdevice", "1", "number of the subdevice [1]"}, board.subdevice);
  visit(FieldName{"channel", "1", "number of the channel [1]"}, board.channel);
  visit(FieldName{"maxdata", "1", "largest code [1]"}, board.maxdata);
  visit(FieldName{"range_min", "V", "lower end of the input range [V]"}, board.range_min_V);
  visit(FieldName{"range_max", "V", "upper end of the input range [V]"}, board.range_max_V);
  visit(FieldName{"polynomial", "V", "voltage by ascending powers of (code - expansion_origin) [V]"},
        board.polynomial);
  visit(FieldName{"expansion_origin", "1", "origin of the polynomial, a code [1]"}, board.expansion_origin);
  visit(FieldName{"calibration", "", ""}, board.calibration);
  visit(FieldName{"acquisition", "", ""}, board.acquisition);
}

template <FieldsOf<daq::BoardInfo> Info, typename Visitor>
void for_each_rate_field(Info& board, Visitor&& visit) {
  visit(FieldName{"scan_rate_requested", "Hz", "scan rate requested [Hz]"}, board.scan_rate_requested_Hz);
  visit(FieldName{"scan_rate_granted", "Hz", "scan rate granted [Hz]"}, board.scan_rate_granted_Hz);
}

template <FieldsOf<friction::TestTruth> Truth, typename Visitor>
void for_each_field(Truth& truth, Visitor&& visit) {
  visit(FieldName{"scene_name", "", ""}, truth.scene_name);
  visit(FieldName{"scene_text", "", ""}, truth.scene_text);
  visit(FieldName{"seed", "1", "seed of the random streams [1]"}, truth.seed);
  visit(FieldName{"mu_s", "1", "true static coefficient S [1]"}, truth.mu_s);
  visit(FieldName{"mu_k", "1", "true kinetic coefficient K [1]"}, truth.mu_k);
  visit(FieldName{"omega", "rad/s", "true angular frequency of the damped oscillator [rad/s]"},
        truth.omega_rad_per_s);
  visit(FieldName{"gamma_over_2omega", "1", "true damping, gamma/(2 omega) [1]"}, truth.gamma_over_2omega);
  visit(FieldName{"pull_speed", "m/s", "true pull speed [m/s]"}, truth.pull_speed_m_per_s);
  visit(FieldName{"oscillation_frequency", "Hz", "true frequency of the oscillation [Hz]"},
        truth.oscillation_frequency_Hz);
  visit(FieldName{"static_coefficient", "1", "static coefficient, traditional rule without noise [1]"},
        truth.static_coefficient);
  visit(FieldName{"kinetic_coefficient", "1", "kinetic coefficient, traditional rule without noise [1]"},
        truth.kinetic_coefficient);
  visit(FieldName{"amplitude", "1", "true half range of the first full cycle [1]"}, truth.amplitude);
}

template <FieldsOf<friction::SolverFacts> Facts, typename Visitor>
void for_each_field(Facts& facts, Visitor&& visit) {
  visit(FieldName{"method", "", ""}, facts.method);
  visit(FieldName{"accuracy", "1", "largest error of the coefficient to be expected [1]"}, facts.accuracy);
  visit(FieldName{"accuracy_asked", "1", "accuracy that the scene asks for [1]"}, facts.accuracy_asked);
  visit(FieldName{"time_per_scan", "s", "time taken by the simulation for each scan [s]"},
        facts.time_per_scan_s);
}

/// Columns of the table of cycles. \param visit  called as visit(FieldName, member pointer).
template <typename Visitor>
void for_each_cycle_column(Visitor&& visit) {
  using friction::Cycle;
  visit(FieldName{"cycle", "1", "number of the cycle, from 0 [1]"}, &Cycle::number);
  visit(FieldName{"first_scan", "1", "scan nearest to the peak [1]"}, &Cycle::first_scan);
  visit(FieldName{"onset_time", "s", "slip onset, after the first scan [s]"}, &Cycle::onset_time_s);
  visit(FieldName{"capture_time", "s", "slip ends in sticking, after the first scan [s]"},
        &Cycle::capture_time_s);
  visit(FieldName{"peak_time", "s", "maximum of the force, after the first scan [s]"}, &Cycle::peak_time_s);
  visit(FieldName{"period", "s", "peak to next peak [s]"}, &Cycle::period_s);
  visit(FieldName{"stick_time", "s", "duration of sticking before the slip [s]"}, &Cycle::stick_time_s);
  visit(FieldName{"slip_time", "s", "duration of the slip [s]"}, &Cycle::slip_time_s);
  visit(FieldName{"peak", "1", "coefficient at the maximum [1]"}, &Cycle::peak);
  visit(FieldName{"trough", "1", "coefficient at the following minimum [1]"}, &Cycle::trough);
  visit(FieldName{"force_drop", "1", "peak - trough, as a coefficient [1]"}, &Cycle::force_drop);
  visit(FieldName{"delta_mu", "1", "S - K of this slip [1]"}, &Cycle::delta_mu);
  visit(FieldName{"delta_mu_standard_error", "1", "standard error of S - K of this slip [1]"},
        &Cycle::delta_mu_standard_error);
  visit(FieldName{"slip_speed_ratio", "1", "largest slip speed over drive speed [1]"},
        &Cycle::slip_speed_ratio);
  visit(FieldName{"flags", "1", "flags of the cycle, bits named in the attribute meaning [1]"},
        &Cycle::flags);
  visit(FieldName{"pull_speed", "m/s", "pull speed at the slip onset [m/s]"}, &Cycle::pull_speed_m_per_s);
}

/// Columns of the table of true slips.
template <typename Visitor>
void for_each_true_cycle_column(Visitor&& visit) {
  using friction::TrueCycle;
  visit(FieldName{"onset_time", "s", "true slip onset, after the first scan [s]"}, &TrueCycle::onset_time_s);
  visit(FieldName{"mu_s", "1", "S in force during the slip [1]"}, &TrueCycle::mu_s);
  visit(FieldName{"mu_k", "1", "K in force during the slip [1]"}, &TrueCycle::mu_k);
}

}  // namespace stickslip::record
