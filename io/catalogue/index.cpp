#include "io/catalogue/index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/base/version.hpp"
#include "core/record/finding_json.hpp"
#include "core/record/sha256.hpp"

namespace stickslip::catalogue {
namespace {

using Json = nlohmann::ordered_json;

/// Columns of a record before its results.
constexpr const char* kFactColumns =
    "start_ns, title, uuid, status, method, sample, grade, direction, side, replicate, slide, batch, "
    "operator, facts, fact_numbers, "
    "regime, rung, codes, findings";
constexpr int kFactCount = 19;

/// "transition_time", "transition_time_error", "transition_time_systematic", … with `suffix` behind each
/// name.
std::string result_columns_sql(const char* suffix) {
  std::string sql;
  const analysis::TestResults none;
  analysis::for_each_result(none, [&](const analysis::ResultName& name, const analysis::Estimate&) {
    for (const char* const part : {"", "_error", "_systematic"})
      sql += fmt::format(", \"{}{}\"{}", name.name, part, suffix);
  });
  return sql;
}

std::string schema() {
  return fmt::format(
      "CREATE TABLE file(id INTEGER PRIMARY KEY, path BLOB NOT NULL UNIQUE, size INTEGER, mtime_ns INTEGER,"
      " inode INTEGER, state INTEGER, why TEXT);"
      "CREATE TABLE record(id INTEGER PRIMARY KEY REFERENCES file ON DELETE CASCADE, {}{});"
      "CREATE INDEX record_start ON record(start_ns);",
      kFactColumns, result_columns_sql(" REAL"));
}

/// Of the tables and of the program, which may read more than the one before.
std::int64_t version_of_schema() {
  record::Sha256 hash;
  const std::string text = schema() + base::kVersion;
  hash.add(std::span{text});
  constexpr int kDigits = 7;  // SQLite keeps 32 bits with a sign.
  return std::stoll(hash.hexadecimal().substr(0, kDigits), nullptr, 16);
}

Database opened(const std::string& path) {
  Database database{path};
  // A kill leaves a journal, from which the next program restores what was before. A search reads each page
  // once or twice: to keep them all takes longer.
  database.run("PRAGMA foreign_keys = ON; PRAGMA synchronous = NORMAL; PRAGMA cache_size = -1000");
  const std::int64_t version = version_of_schema();
  const auto is_current = [&] {
    Statement asked = database.prepare("PRAGMA user_version");
    return asked.step() && asked.whole(0) == version;
  };
  if (is_current()) return database;
  Transaction transaction{database};
  if (!is_current()) {  // Another process may have been faster.
    database.run("DROP TABLE IF EXISTS record; DROP TABLE IF EXISTS file;" + schema() +
                 fmt::format("PRAGMA user_version = {}", version));
  }
  transaction.commit();
  return database;
}

std::string placeholders(std::size_t count) {
  std::string sql = "?";
  for (std::size_t i = 1; i < count; ++i) sql += ", ?";
  return sql;
}

std::size_t result_count() {
  std::size_t count = 0;
  const analysis::TestResults none;
  analysis::for_each_result(none, [&](const analysis::ResultName&, const analysis::Estimate&) { ++count; });
  return count;
}

template <typename T>
Value value_of(const std::optional<T>& value) {
  return value ? Value{*value} : Value{};
}

/// " slack misfit warning ", for has_finding().
std::string codes_of(const std::vector<base::Finding>& findings) {
  std::string codes;
  for (const base::Finding& finding : findings)
    codes += fmt::format(" {} {} ", finding.code, base::name(finding.severity));
  return codes;
}

/// \throws SqlError if they are none: the row is damaged.
std::vector<base::Finding> findings_from(const std::string& json) {
  std::vector<base::Finding> findings;
  try {
    findings = record::findings_in(Json{{record::kCodedFindings, Json::parse(json)}});
  } catch (const Json::exception&) {  // Told below.
  }
  if (findings.empty()) throw SqlError("the findings of a record are damaged", Trouble::kDamage);
  return findings;
}

/// \throws SqlError if they are none: the row is damaged.
record::Metadata facts_from(const std::string& json) {
  if (json.empty()) return {};
  try {
    return Json::parse(json).get<record::Metadata>();
  } catch (const Json::exception&) {
    throw SqlError("the facts of a record are damaged", Trouble::kDamage);
  }
}

/// {"temperature": 23.0}, in the units of known_facts().
std::string numbers_of(const record::Metadata& facts) {
  Json numbers = Json::object();
  for (const auto& [key, value] : facts) {
    if (const auto number = record::fact_number(key, value)) numbers[key] = *number;
  }
  return numbers.dump();
}

/// Fills an empty entry from a row of find().
void read_entry(const Statement& row, Entry& entry) {
  int column = 0;
  const auto text = [&] { return row.text(column++); };
  entry.file = text();
  entry.start_realtime_ns = row.maybe_whole(column++);
  entry.title = text();
  entry.uuid = text();
  entry.status = text();
  entry.method = text();
  entry.sample.name = text();
  entry.sample.grade = text();
  entry.sample.direction = text();
  entry.sample.side = text();
  entry.sample.replicate = row.maybe_whole(column++);
  entry.sample.slide = row.maybe_whole(column++);
  entry.sample.batch = text();
  entry.sample.operator_name = text();
  entry.sample.metadata = facts_from(text());
  ++column;  // Their numbers.
  entry.results.regime = model::regime_from_name(text()).value_or(model::Regime::kUndecided);
  entry.results.rung = analysis::rung_from_name(text()).value_or(analysis::Rung::kNone);
  const bool has_findings = !text().empty();
  const std::string findings = text();
  if (has_findings) entry.results.findings = findings_from(findings);
  analysis::for_each_result(entry.results, [&](const analysis::ResultName&, analysis::Estimate& estimate) {
    estimate.value = row.maybe_number(column++);
    estimate.standard_error = row.maybe_number(column++);
    estimate.systematic_uncertainty = row.maybe_number(column++);
  });
}

/// What is asked of the records that meet the conditions, with the values to bind.
/// \param sql  "SELECT … FROM …".
Condition chosen(const std::string& sql, const Query& query) {
  Condition all{sql + " WHERE 1", {}};
  for (const Condition& condition : query.conditions) {
    all.sql += " AND (" + condition.sql + ")";
    all.values.insert(all.values.end(), condition.values.begin(), condition.values.end());
  }
  return all;
}

}  // namespace

Index::Index(const std::string& path)
    : database_(opened(path)),
      put_file_(database_.prepare("INSERT INTO file(path, size, mtime_ns, inode, state, why)"
                                  " VALUES(?, ?, ?, ?, ?, ?)")),
      put_record_(database_.prepare(fmt::format("INSERT INTO record(id, {}{}) VALUES({})", kFactColumns,
                                                result_columns_sql(""),
                                                placeholders(1 + kFactCount + 3 * result_count())))),
      remove_(database_.prepare("DELETE FROM file WHERE path = ?")) {}

std::vector<KnownFile> Index::files() {
  std::vector<KnownFile> files;
  Statement all = database_.prepare("SELECT path, size, mtime_ns, inode, state FROM file ORDER BY path");
  while (all.step()) {
    files.push_back(
        {all.text(0), {all.whole(1), all.whole(2), all.whole(3)}, static_cast<State>(all.whole(4))});
  }
  return files;
}

std::int64_t Index::put_file(const UnreadFile& file, const Signature& signature) {
  remove(file.file);
  put_file_.run({Bytes{file.file}, signature.size, signature.mtime_ns, signature.inode,
                 static_cast<std::int64_t>(file.state), file.why});
  return database_.last_id();
}

void Index::put(const std::string& file, const Signature& signature, const record::Record& record) {
  const record::RecordHeader& header = record.header;
  const record::SampleFacts& sample = header.sample;
  const analysis::TestResults& results = record.end->results;
  const std::string codes = codes_of(results.findings);
  std::vector<Value> values{put_file({file, State::kRead, {}}, signature),
                            value_of(header.start_realtime_ns),
                            header.title,
                            header.uuid,
                            std::string{record::name(record.end->status)},
                            header.process.method,
                            sample.name,
                            sample.grade,
                            sample.direction,
                            sample.side,
                            value_of(sample.replicate),
                            value_of(sample.slide),
                            sample.batch,
                            sample.operator_name,
                            sample.metadata.empty() ? std::string{} : Json(sample.metadata).dump(),
                            numbers_of(sample.metadata),
                            std::string{model::name(results.regime)},
                            std::string{analysis::name(results.rung)},
                            codes,
                            codes.empty() ? std::string{}
                                          : record::findings_json<Json>(results.findings)
                                                .dump(-1, ' ', false, Json::error_handler_t::replace)};
  analysis::for_each_result(results, [&](const analysis::ResultName&, const analysis::Estimate& estimate) {
    values.push_back(value_of(estimate.value));
    values.push_back(value_of(estimate.standard_error));
    values.push_back(value_of(estimate.systematic_uncertainty));
  });
  put_record_.run(values);
}

void Index::put_unread(const UnreadFile& file, const Signature& signature) { put_file(file, signature); }

void Index::remove(const std::string& file) { remove_.run({Bytes{file}}); }

Matches Index::find(const Query& query) {
  Matches found{.entries = {}, .count = count(query)};
  const bool by_date = query.order.empty() || query.order == "start_ns";
  // Of the dates there is an index, which an expression would not use.
  const std::string order = fmt::format(" ORDER BY {0}{1} NULLS LAST, path{1}",
                                        by_date ? "start_ns" : fmt::format("nullif(\"{}\", '')", query.order),
                                        query.reversed ? " DESC" : "");
  auto [which, values] = chosen("SELECT id FROM record JOIN file USING(id)", query);
  // Which ones first: to sort whole rows takes thrice as long.
  if (query.most) {
    which += order + " LIMIT ?";
    values.emplace_back(*query.most);
  }
  const std::string sql = fmt::format("SELECT path, {}{} FROM record JOIN file USING(id) WHERE id IN ({}){}",
                                      kFactColumns, result_columns_sql(""), which, order);
  Statement rows = database_.prepare(sql);
  rows.bind(values);
  // An entry is large: it is made where it stays.
  found.entries.reserve(query.most ? std::min(found.count, static_cast<std::size_t>(*query.most))
                                   : found.count);
  while (rows.step()) read_entry(rows, found.entries.emplace_back());
  // Another search may have changed the index in between.
  found.count = query.most ? std::max(found.count, found.entries.size()) : found.entries.size();
  return found;
}

std::size_t Index::count(const Query& query) {
  const auto [sql, values] = chosen("SELECT count(*) FROM record", query);
  Statement row = database_.prepare(sql);
  row.bind(values);
  row.step();
  return static_cast<std::size_t>(row.whole(0));
}

std::vector<UnreadFile> Index::unread() {
  std::vector<UnreadFile> unread;
  Statement rows = database_.prepare("SELECT path, state, why FROM file WHERE state <> 0 ORDER BY path");
  while (rows.step()) unread.push_back({rows.text(0), static_cast<State>(rows.whole(1)), rows.text(2)});
  return unread;
}

}  // namespace stickslip::catalogue
