#include "core/record/sweep_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <numeric>
#include <string>
#include <vector>

#include "core/base/contract.hpp"
#include "core/record/file.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/record.hpp"

namespace stickslip::record {
namespace {

constexpr const char* kValue = "value";
constexpr const char* kRepeat = "repeat";
/// Shown when nothing else is asked for.
constexpr const char* kDefaultResult = "delta_mu";

/// Another name for the same data set.
void link(hid_t from, const std::string& name, hid_t to, const std::string& new_name) {
  check(H5Lcreate_hard(from, name.c_str(), to, new_name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
        "link " + new_name);
}

/// \param names  model::kRegimeNames or analysis::kRungNames.
std::vector<std::string> words_of(const auto& names) {
  std::vector<std::string> words;
  words.reserve(std::size(names));
  for (const auto& [value, word] : names) words.emplace_back(word);
  return words;
}

class SweepWriter {
 public:
  SweepWriter(hid_t entry, const SweepFacts& facts, const SweepTable& table)
      : entry_(entry), facts_(facts), table_(table) {
    for (const SweepAxis& axis : facts.axes) {
      axes_.push_back(axis.key);
      shape_.push_back(axis.values.size());
    }
    axes_.emplace_back(kRepeat);
    shape_.push_back(static_cast<hsize_t>(facts.repeat));
  }

  void write() {
    write_text(entry_, "title", facts_.command);
    write_process();
    write_axes();
    write_truth();
    for (const SweepTable::Result& result : table_.results()) write_result(result);
    const GroupHandle regime = make_data_group("regime");
    const FieldName name{kValue, "1", "regime of the sled's motion, named in the attribute words [1]"};
    const DatasetHandle value = write_array<std::uint8_t>(regime.get(), name, shape_, table_.regime());
    write_attribute(value.get(), "words", words_of(model::kRegimeNames));
    link_truth(regime.get(), "regime");
    const GroupHandle rung = make_data_group("rung");
    const FieldName rung_name{kValue, "1", "rung of S and K, named in the attribute words [1]"};
    const DatasetHandle rungs = write_array<std::uint8_t>(rung.get(), rung_name, shape_, table_.rung());
    write_attribute(rungs.get(), "words", words_of(analysis::kRungNames));
  }

 private:
  void write_process() const {
    const GroupHandle group = make_group(entry_, "process", "NXprocess");
    write_text(group.get(), "program", "stickslip sweep");
    write_text(group.get(), "version", facts_.version);
    write_text(group.get(), "commit", facts_.commit);
    write_text(group.get(), "command", facts_.command);
    write_text(group.get(), "method", facts_.method);
    write_text(group.get(), "scene_name", facts_.scene_name);
    write_text(group.get(), "scene_text", facts_.scene_text);
    write_scalar(group.get(), {"seed", "1", "seed from which each run has its own [1]"}, facts_.seed);
  }

  void write_axes() const {
    const GroupHandle group = make_group(entry_, "axes", "NXcollection");
    for (const SweepAxis& axis : facts_.axes) {
      const std::string long_name = fmt::format("{} [{}]", axis.key, axis.unit);
      const DatasetHandle values =
          write_column<double>(group.get(), {axis.key, axis.unit, long_name}, axis.values);
      if (!axis.words.empty()) write_attribute(values.get(), "words", axis.words);
    }
    std::vector<std::int64_t> repeat(static_cast<std::size_t>(facts_.repeat));
    std::iota(repeat.begin(), repeat.end(), 0);
    write_column<std::int64_t>(group.get(), {kRepeat, "1", "number of the repetition, from 0 [1]"}, repeat);
  }

  void write_truth() const {
    const GroupHandle group = make_group(entry_, "truth", "NXcollection");
    for (const SweepTable::Truth& truth : table_.truths()) {
      write_array<double>(group.get(), truth.name, shape_, truth.value);
    }
    const DatasetHandle regime = write_array<std::uint8_t>(
        group.get(), {"regime", "1", "true regime, named in the attribute words [1]"}, shape_,
        table_.true_regime());
    write_attribute(regime.get(), "words", words_of(model::kRegimeNames));
    write_array<std::uint64_t>(group.get(), {"seed", "1", "seed of the run [1]"}, shape_, table_.seed());
  }

  /// With its axes; the signal is still to be written.
  [[nodiscard]] GroupHandle make_data_group(const std::string& name) const {
    GroupHandle group = make_group(entry_, name, "NXdata");
    write_attribute(group.get(), "signal", kValue);
    write_attribute(group.get(), "axes", axes_);
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      write_number_attribute(group.get(), axes_[i] + "_indices", static_cast<std::int64_t>(i));
      link(entry_, "axes/" + axes_[i], group.get(), axes_[i]);
    }
    return group;
  }

  /// Where there is one.
  void link_truth(hid_t group, const std::string& name) const {
    const std::string truth = "truth/" + name;
    const htri_t known = H5Lexists(entry_, truth.c_str(), H5P_DEFAULT);
    check(known, "looking for " + truth);
    if (known > 0) link(entry_, truth, group, "truth");
  }

  void write_result(const SweepTable::Result& result) const {
    const std::string name{result.name.name};
    const GroupHandle group = make_data_group(name);
    const std::string long_name = fmt::format("{} [{}]", result.name.long_name, result.name.unit);
    write_array<double>(group.get(), {kValue, result.name.unit, long_name}, shape_, result.value);
    const std::string error_name = fmt::format("standard error of the {}", long_name);
    write_array<double>(group.get(), {kStandardError, result.name.unit, error_name}, shape_,
                        result.standard_error);
    link(group.get(), kStandardError, group.get(), "value_errors");  // The name that viewers look for.
    const std::string systematic_name = fmt::format("systematic uncertainty of the {}", long_name);
    write_array<double>(group.get(), {kSystematic, result.name.unit, systematic_name}, shape_,
                        result.systematic_uncertainty);
    std::vector<std::string_view> reasons;
    reasons.reserve(result.reason.size());
    for (const std::uint32_t reason : result.reason) reasons.push_back(table_.reasons()[reason]);
    write_text_array(group.get(), "reason", shape_, reasons);
    link_truth(group.get(), name);
  }

  hid_t entry_;
  const SweepFacts& facts_;
  const SweepTable& table_;
  std::vector<std::string> axes_;
  std::vector<hsize_t> shape_;
};

/// \throws HdfError with the file in an unknown state: it is to be thrown away.
void build(const SweepFacts& facts, const SweepTable& table, const std::filesystem::path& path) {
  FileHandle file = create_file(path);
  write_attribute(file.get(), "NX_class", "NXroot");
  write_attribute(file.get(), "default", "entry");
  write_attribute(file.get(), "creator", "stickslip sweep");
  write_attribute(file.get(), "creator_version", facts.version);
  write_attribute(file.get(), "format", kSweepFormat);
  write_number_attribute(file.get(), "format_version", kSweepFormatVersion);
  {
    const GroupHandle entry = make_group(file.get(), "entry", "NXentry");
    write_attribute(entry.get(), "default", kDefaultResult);
    SweepWriter{entry.get(), facts, table}.write();
  }
  finish_file(std::move(file));
}

}  // namespace

base::Result<void> publish_sweep(const SweepFacts& facts, const SweepTable& table,
                                 const std::filesystem::path& path) {
  STICKSLIP_EXPECTS(static_cast<std::int64_t>(table.run_count()) == facts.run_count());
  std::filesystem::path temporary = path;
  temporary += '.' + make_uuid() + ".tmp";
  base::Result<void> published;
  try {
    build(facts, table, temporary);
    published = sync_path(temporary);
    if (published) published = rename_to_new(temporary, path);
  } catch (const std::exception& error) {
    published = base::failure("{}: cannot be written: {}", temporary.string(), error.what());
  }
  if (!published) ::unlink(temporary.c_str());
  return published;
}

}  // namespace stickslip::record
