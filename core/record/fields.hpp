/// \file
/// Tables of the plain fields of a record's structs, with name, unit and meaning. The journal's JSON, the
/// HDF5 writer and the HDF5 reader all use them, so that a field added here is stored by all. A number added
/// must be optional: readers throw if a file, such as an older one, lacks a plain number. Not in the tables:
/// enumerations, results, operator, metadata, gaps, events, clock anchors, and the plain members of
/// RecordHeader and EndRecord.
///
///     for_each_field(header.tester, [](const FieldName& name, auto& value) { … });
///
/// Values are strings (empty = not known), numbers, optional numbers, or vectors (empty = not known) of
/// double or strings.
#pragma once

#include <concepts>
#include <string_view>
#include <type_traits>

#include "core/record/record.hpp"

namespace stickslip::record {

/// Names of a result's attributes, and of the columns of a sweep with the same meaning.
inline constexpr const char* kStandardError = "standard_error";
inline constexpr const char* kSystematic = "systematic_uncertainty";

struct FieldName {
  std::string_view name;
  std::string_view unit;       ///< SI, "1" for a ratio, a number or a count; empty for text.
  std::string_view long_name;  ///< Meaning with the unit, for axes; empty for text.
};

/// `const Fields` or `Fields`: each table serves reading and writing.
template <typename T, typename Fields>
concept FieldsOf = std::same_as<std::remove_const_t<T>, Fields>;

template <FieldsOf<TesterFacts> Fields, typename Visitor>
void for_each_field(Fields& fields, Visitor&& visit) {
  visit(FieldName{"sled_mass", "kg", "mass of the sled [kg]"}, fields.sled_mass_kg);
  visit(FieldName{"gravity", "m/s^2", "acceleration of gravity [m/s^2]"}, fields.gravity_m_per_s2);
  visit(FieldName{"pull_speed", "m/s", "nominal pull speed [m/s]"}, fields.pull_speed_m_per_s);
  visit(FieldName{"stiffness", "N/m", "stiffness of the coupling [N/m]"}, fields.stiffness_N_per_m);
  visit(FieldName{"speed_course", "", ""}, fields.speed_course);
  visit(FieldName{"load_cell_frequency", "Hz", "natural frequency of the load cell [Hz]"},
        fields.load_cell_frequency_Hz);
  visit(FieldName{"load_cell_damping", "1", "damping of the load cell over the critical one [1]"},
        fields.load_cell_damping);
  visit(FieldName{"anti_alias", "Hz", "corner of the Butterworth filter before the converter [Hz]"},
        fields.anti_alias_Hz);
  visit(FieldName{"anti_alias_order", "1", "order of that filter [1]"}, fields.anti_alias_order);
}

template <FieldsOf<CalibrationFacts> Fields, typename Visitor>
void for_each_field(Fields& fields, Visitor&& visit) {
  visit(FieldName{"date", "", ""}, fields.date);
  visit(FieldName{"certificate", "", ""}, fields.certificate);
  visit(FieldName{"gain_standard_error", "N/V", "standard error of the load cell gain [N/V]"},
        fields.gain_standard_error_N_per_V);
  visit(FieldName{"zero_standard_error", "V", "standard error of the load cell zero [V]"},
        fields.zero_standard_error_V);
  visit(FieldName{"residual", "V", "standard deviation of the readings about the line [V]"},
        fields.residual_V);
  visit(FieldName{"hysteresis", "V", "reading under falling less that under rising loads [V]"},
        fields.hysteresis_V);
  visit(FieldName{"expires", "", ""}, fields.expires);
  visit(FieldName{"replaced_gain", "N/V",
                  "gain in use before this calibration, if the change was confirmed [N/V]"},
        fields.replaced_gain_N_per_V);
  visit(FieldName{"weight_mass", "kg", "mass of each weight hung [kg]"}, fields.mass_kg);
  visit(FieldName{"weight_force", "N", "force of each weight hung [N]"}, fields.force_N);
  visit(FieldName{"weight_voltage", "V", "voltage under each weight [V]"}, fields.voltage_V);
  visit(FieldName{"weight_voltage_standard_error", "V", "standard error of the voltage [V]"},
        fields.voltage_standard_error_V);
  visit(FieldName{"weight_residual", "V", "voltage under each weight less that of the line [V]"},
        fields.point_residual_V);
  visit(FieldName{"weight_refused", "", ""}, fields.refused);
}

template <FieldsOf<PlanFacts> Fields, typename Visitor>
void for_each_field(Fields& fields, Visitor&& visit) {
  visit(FieldName{"start_coefficient", "1", "a test begins above this coefficient [1]"},
        fields.start_coefficient);
  visit(FieldName{"start_dwell", "s", "for so long [s]"}, fields.start_dwell_s);
  visit(FieldName{"pre_trigger", "s", "kept from before the trigger [s]"}, fields.pre_trigger_s);
  visit(FieldName{"end_coefficient", "1", "a test ends below this coefficient [1]"}, fields.end_coefficient);
  visit(FieldName{"end_dwell", "s", "for so long [s]"}, fields.end_dwell_s);
  visit(FieldName{"no_motion_dwell", "s", "or when it lies flat for so long [s]"}, fields.no_motion_dwell_s);
  visit(FieldName{"unloaded_level", "1", "above this coefficient, which the unloaded cell read [1]"},
        fields.unloaded_level);
}

/// All fields of the self-check except its raw readings, which are written separately.
template <FieldsOf<daq::SelfCheck> Check, typename Visitor>
void for_each_field(Check& check, Visitor&& visit) {
  visit(FieldName{"first_scan", "1", "first scan looked at [1]"}, check.first_scan);
  visit(FieldName{"zero", "N", "mean force with no load [N]"}, check.zero_N);
  visit(FieldName{"zero_standard_error", "N", "standard error of the mean force with no load [N]"},
        check.zero_standard_error_N);
  visit(FieldName{"drift", "N/s", "drift of the force with no load [N/s]"}, check.drift_N_per_s);
  visit(FieldName{"drift_standard_error", "N/s", "standard error of the drift [N/s]"},
        check.drift_standard_error_N_per_s);
  visit(FieldName{"noise", "N", "standard deviation of one scan with no load [N]"}, check.noise_N);
  visit(FieldName{"hum_at_50_Hz", "N", "amplitude of 50 Hz with no load [N]"}, check.hum_at_50_Hz_N);
  visit(FieldName{"hum_at_60_Hz", "N", "amplitude of 60 Hz with no load [N]"}, check.hum_at_60_Hz_N);
  visit(FieldName{"hum_standard_error", "N", "standard error of the amplitudes [N]"},
        check.hum_standard_error_N);
  visit(FieldName{"spike_count", "1", "spikes with no load [1]"}, check.spike_count);
  visit(FieldName{"saturated_count", "1", "scans at a rail with no load [1]"}, check.saturated_count);
  visit(FieldName{"scan_rate", "Hz", "scan rate by the clock, up to the test [Hz]"}, check.scan_rate_Hz);
  visit(FieldName{"scan_rate_standard_error", "Hz", "standard error of the scan rate [Hz]"},
        check.scan_rate_standard_error_Hz);
  visit(FieldName{"findings", "", ""}, check.findings);
}

template <FieldsOf<daq::LoadCell> Fields, typename Visitor>
void for_each_field(Fields& fields, Visitor&& visit) {
  visit(FieldName{"gain", "N/V", "force per voltage of the load cell [N/V]"}, fields.gain_N_per_V);
  visit(FieldName{"zero", "V", "voltage at no force [V]"}, fields.zero_V);
}

template <FieldsOf<SampleFacts> Fields, typename Visitor>
void for_each_field(Fields& fields, Visitor&& visit) {
  visit(FieldName{"name", "", ""}, fields.name);
  visit(FieldName{"grade", "", ""}, fields.grade);
  visit(FieldName{"direction", "", ""}, fields.direction);
  visit(FieldName{"side", "", ""}, fields.side);
  visit(FieldName{"replicate", "1", "number of the replicate, from 1 [1]"}, fields.replicate);
  visit(FieldName{"slide", "1", "number of the pull of this sheet, from 1 [1]"}, fields.slide);
  visit(FieldName{"batch", "", ""}, fields.batch);
}

template <FieldsOf<ProcessFacts> Fields, typename Visitor>
void for_each_field(Fields& fields, Visitor&& visit) {
  visit(FieldName{"program", "", ""}, fields.program);
  visit(FieldName{"version", "", ""}, fields.version);
  visit(FieldName{"commit", "", ""}, fields.commit);
  visit(FieldName{"configuration", "", ""}, fields.configuration);
  visit(FieldName{"estimator", "", ""}, fields.estimator);
  visit(FieldName{"method", "", ""}, fields.method);
  visit(FieldName{"kept", "", ""}, fields.kept);
  visit(FieldName{"characterisation", "", ""}, fields.characterisation);
  visit(FieldName{"realtime", "", ""}, fields.realtime);
  visit(FieldName{"simulation", "", ""}, fields.simulation);
  visit(FieldName{"source_file", "", ""}, fields.source_file);
  visit(FieldName{"source_size", "1", "bytes of the imported file [1]"}, fields.source_size);
  visit(FieldName{"source_sha256", "", ""}, fields.source_sha256);
  visit(FieldName{"source_reading", "", ""}, fields.source_reading);
  visit(FieldName{"source_command", "", ""}, fields.source_command);
}

/// All fields of the second channel except its quantity, which must be set before the call.
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

/// Driver, board and device.
template <FieldsOf<daq::BoardInfo> Info, typename Visitor>
void for_each_name_field(Info& board, Visitor&& visit) {
  visit(FieldName{"driver", "", ""}, board.driver);
  visit(FieldName{"board", "", ""}, board.board_name);
  visit(FieldName{"device", "", ""}, board.device);
}

/// Fields of the converter. HDF5 files have them only if the raw values are counts; journals always.
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

template <FieldsOf<model::TestTruth> Truth, typename Visitor>
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

template <FieldsOf<model::SolverFacts> Fields, typename Visitor>
void for_each_field(Fields& fields, Visitor&& visit) {
  visit(FieldName{"method", "", ""}, fields.method);
  visit(FieldName{"accuracy", "1", "largest error of the coefficient to be expected [1]"}, fields.accuracy);
  visit(FieldName{"accuracy_asked", "1", "accuracy that the scene asks for [1]"}, fields.accuracy_asked);
  visit(FieldName{"time_per_scan", "s", "time taken by the simulation for each scan [s]"},
        fields.time_per_scan_s);
}

/// Columns of the table of cycles. A new one goes to the end, and into came_later() of layout_tables.cpp,
/// since older records lack it.
/// \param visit  called as visit(FieldName, member pointer).
template <typename Visitor>
void for_each_cycle_column(Visitor&& visit) {
  using detect::Cycle;
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
  visit(FieldName{"capture_evidence", "1", "log likelihood ratio of captured over free [1]"},
        &Cycle::capture_evidence);
  visit(FieldName{"live_capture_evidence", "1",
                  "log likelihood ratio of captured over free when it was decided during the test [1]"},
        &Cycle::live_capture_evidence);
  visit(FieldName{"live_decision_time", "s", "when that was, after the first scan [s]"},
        &Cycle::live_decision_time_s);
}

/// Columns of the table of true slips. None can be added: journals do not state the number of columns, and
/// readers expect these.
/// \param visit  called as visit(FieldName, member pointer).
template <typename Visitor>
void for_each_true_cycle_column(Visitor&& visit) {
  using model::TrueCycle;
  visit(FieldName{"onset_time", "s", "true slip onset, after the first scan [s]"}, &TrueCycle::onset_time_s);
  visit(FieldName{"mu_s", "1", "S in force during the slip [1]"}, &TrueCycle::mu_s);
  visit(FieldName{"mu_k", "1", "K in force during the slip [1]"}, &TrueCycle::mu_k);
}

}  // namespace stickslip::record
