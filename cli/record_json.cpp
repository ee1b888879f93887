#include "cli/record_json.hpp"

#include <fmt/format.h>

#include "io/results_json.hpp"
#include <nlohmann/json.hpp>

#include "core/base/contract.hpp"
#include "core/record/iso_time.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

/// What is known of the sample, and what the user of an import stated.
Json facts_of(const record::RecordHeader& header) {
  Json facts = Json::object();
  const auto put = [&facts](const char* name, const std::string& value) {
    if (!value.empty()) facts[name] = value;
  };
  put("title", header.title);
  put("uuid", header.uuid);
  if (header.start_realtime_ns) put("start_time", record::iso_time(*header.start_realtime_ns));
  put("sample", header.sample.name);
  put("grade", header.sample.grade);
  put("direction", header.sample.direction);
  put("side", header.sample.side);
  if (header.sample.replicate) facts["replicate"] = *header.sample.replicate;
  put("operator", header.sample.operator_name);
  put("method", header.process.method);
  put("source_file", header.process.source_file);
  const model::Transducer transducer = header.tester.tester().transducer;
  if (transducer.load_cell) {
    put("load_cell", fmt::format("{:.6g} Hz, damping {:.3g}", transducer.load_cell->frequency_Hz,
                                 transducer.load_cell->damping_ratio));
  }
  if (transducer.anti_alias) {
    put("anti_alias",
        fmt::format("{:.6g} Hz, order {}", transducer.anti_alias->cutoff_Hz, transducer.anti_alias->order));
  }
  return facts;
}

}  // namespace

Json record_json(const std::string& file, const record::Record& record) {
  STICKSLIP_EXPECTS(record.end.has_value());
  return {{"file", file},
          {"cause", record.end->cause},
          {"facts", facts_of(record.header)},
          {"metadata", record.header.sample.metadata},
          {"results", io::results_json(record.end->results, true)}};
}

}  // namespace stickslip::cli
