/// \file
/// SQLite: a file of tables, statements with bound values, transactions. Thread-bound. All functions throw
/// SqlError.
///
///     Database database{path};
///     Statement statement = database.prepare("SELECT size FROM file WHERE path = ?");
///     statement.bind({Bytes{path}});
///     while (statement.step()) use(statement.whole(0));
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace stickslip::catalogue {

/// Why SQLite refuses.
enum class Trouble : std::uint8_t {
  kDamage,   ///< The file is no database, a damaged one, or one without the tables that it should have.
  kLocked,   ///< Another process writes it, for longer than one waits.
  kNoPlace,  ///< The file cannot be opened, read or written, or the disk is full.
  kOther,
};

/// What SQLite refuses, in its own words.
class SqlError : public std::runtime_error {
 public:
  SqlError(const std::string& message, Trouble trouble) : std::runtime_error(message), trouble_(trouble) {}
  [[nodiscard]] Trouble trouble() const noexcept { return trouble_; }

 private:
  Trouble trouble_;
};

/// A path, which need not be UTF-8.
struct Bytes {
  std::string bytes;
};

/// Of a parameter; monostate: NULL.
using Value = std::variant<std::monostate, std::int64_t, double, std::string, Bytes>;

class Statement {
 public:
  Statement(sqlite3* database, const std::string& sql);

  /// Sets all parameters, the first one first, and starts again.
  void bind(const std::vector<Value>& values);
  /// Goes to the next row. \return false behind the last.
  bool step();
  /// bind() and step() of what gives no rows.
  void run(const std::vector<Value>& values);

  // Columns of the row, from 0.
  [[nodiscard]] std::int64_t whole(int column) const;
  [[nodiscard]] std::string text(int column) const;  ///< Empty for NULL.
  [[nodiscard]] std::optional<std::int64_t> maybe_whole(int column) const;
  [[nodiscard]] std::optional<double> maybe_number(int column) const;

 private:
  std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement_;
  sqlite3* database_;
};

class Database {
 public:
  /// Opens or makes the file. Waits ten seconds for another process. \param path  ":memory:" for none.
  explicit Database(const std::string& path);

  [[nodiscard]] Statement prepare(const std::string& sql) { return {database_.get(), sql}; }
  /// Statements without parameters.
  void run(const std::string& sql);
  [[nodiscard]] std::int64_t last_id() const;

 private:
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_;
};

/// Undone unless it is committed. Begins at once, so that no reader has to become a writer.
class Transaction {
 public:
  explicit Transaction(Database& database) : database_(database) { database_.run("BEGIN IMMEDIATE"); }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  ~Transaction();
  void commit();

 private:
  Database& database_;
  bool open_ = true;
};

}  // namespace stickslip::catalogue
