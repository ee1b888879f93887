/// \file
/// The index of a folder's records: a row for each file, and what a search asks of its record. It holds
/// nothing that is not in the files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/catalogue/condition.hpp"
#include "io/catalogue/database.hpp"

#include "core/analysis/results.hpp"
#include "core/record/record.hpp"

namespace stickslip::catalogue {

/// By which a changed file is told from an unchanged one, without reading it.
struct Signature {
  std::int64_t size = 0;
  std::int64_t mtime_ns = 0;
  std::int64_t inode = 0;

  bool operator==(const Signature&) const = default;
};

enum class State : std::uint8_t {
  kRead,
  kUnreadable,  ///< Damaged, or no record: not read anew until the file changes.
  /// The system refuses it, a program is writing it, or its reader died: tried again each time.
  kNotLooked,
};

struct KnownFile {
  std::string file;
  Signature signature;
  State state = State::kRead;
};

/// A file without a record that can be searched.
struct UnreadFile {
  std::string file;
  State state = State::kUnreadable;
  std::string why;
};

/// A record, as far as it is searched and shown.
struct Entry {
  std::string file;  ///< From the folder on.
  std::optional<std::int64_t> start_realtime_ns;
  std::string title;
  std::string uuid;
  std::string status;
  std::string method;
  record::SampleFacts sample;
  analysis::TestResults results;  ///< Without reasons.
};

struct Matches {
  std::vector<Entry> entries;  ///< The first Query::most.
  std::size_t count = 0;       ///< Of all records that meet the conditions.
};

/// Functions throw SqlError.
class Index {
 public:
  /// Opens or makes it. One of another version of the program is emptied. \param path  ":memory:" for none.
  explicit Index(const std::string& path);

  /// Sorted by the bytes of their names.
  [[nodiscard]] std::vector<KnownFile> files();
  [[nodiscard]] Transaction begin() { return Transaction{database_}; }
  // Within a transaction.
  void put(const std::string& file, const Signature& signature, const record::Record& record);
  void put_unread(const UnreadFile& file, const Signature& signature);
  void remove(const std::string& file);

  [[nodiscard]] Matches find(const Query& query);
  [[nodiscard]] std::vector<UnreadFile> unread();

 private:
  std::size_t count(const Query& query);
  std::int64_t put_file(const UnreadFile& file, const Signature& signature);

  Database database_;
  Statement put_file_;
  Statement put_record_;
  Statement remove_;
};

}  // namespace stickslip::catalogue
