/// \file
/// The same scans into a plain HDF5 file by h5py (h5py_peer.py), in a process of its own that measures its
/// own time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "io/child_process.hpp"
#include <nlohmann/json.hpp>

#include "core/base/result.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::bench {

enum class Flush { kAtTheEnd, kEachSecond };

struct H5pyOutcome {
  double write_s = 0.0;           ///< Everything, the last sync included.
  std::vector<double> commits_s;  ///< Of each second: append, flush, sync. None with Flush::kAtTheEnd.
  std::uint64_t size = 0;         ///< Of the file, bytes.
};

/// \param raw  codes of 16 bits. Errors: kFailure without Debian's python3-h5py.
inline base::Result<H5pyOutcome> write_with_h5py(const std::vector<double>& raw, double scan_rate_Hz,
                                                 Flush flush) {
  const test::TemporaryFolder folder;
  {
    const std::vector<std::uint16_t> codes(raw.begin(), raw.end());
    std::ofstream file{folder / "codes.u16", std::ios::binary};
    file.write(reinterpret_cast<const char*>(codes.data()),  // NOLINT(*-reinterpret-cast): bytes of a file.
               static_cast<std::streamsize>(codes.size() * sizeof(std::uint16_t)));
  }
  const std::string script = std::string{STICKSLIP_SOURCE_DIR} + "/bench/h5py_peer.py";
  // Range, largest code, gain and weight of the scene: what they are makes no difference to the time.
  const auto answer = io::ask_program(
      "/usr/bin/python3",
      {script, (folder / "codes.u16").string(), std::to_string(scan_rate_Hz), "20", "65535", "2", "22.86",
       flush == Flush::kEachSecond ? "second" : "end", (folder / "peer.h5").string()},
      "");
  if (!answer) return tl::unexpected(answer.error());
  if (!*answer || (*answer)->status != 0)
    return base::failure("h5py: {}", *answer ? (*answer)->errors : "there is no /usr/bin/python3");
  const auto json = nlohmann::json::parse((*answer)->output);
  return H5pyOutcome{json.at("write_s").get<double>(), json.at("commits_s").get<std::vector<double>>(),
                     json.at("size").get<std::uint64_t>()};
}

}  // namespace stickslip::bench
