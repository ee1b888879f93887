// Subcommands that evaluate records: analyze, characterise.

#include "cli/commands.hpp"
#include "cli/subcommands.hpp"

namespace stickslip::cli {
namespace {

void add_analyze(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<AnalyzeCommand>();
  AnalyzeCommand& analysis = *kept;
  CLI::App* analyze = app.add_subcommand("analyze", "run the detector and the estimators over records");
  analyze->add_option("files", analysis.files, "records")->required()->type_name("FILE.h5");
  add_method_option(*analyze, analysis.method);
  analyze
      ->add_option(
          "--tester", analysis.tester,
          "what `stickslip characterise` wrote: S and K become surer, and what speaks against it is told")
      ->type_name("FILE.toml");
  analyze
      ->add_option(
          "--estimator", analysis.estimator,
          "where S and K come from: \"peak\" (largest scan and mean of each cycle), \"interpolated\" "
          "(turning points), \"fit\" (all scans, and with them omega, gamma and what needs them); default: "
          "as the "
          "record says")
      ->type_name("NAME");
  analyze
      ->add_option("--keep", analysis.keep,
                   "leave in what is taken care of otherwise, to see what it does: \"spikes\", \"drift\", "
                   "\"first-slip\" (its peak is often not representative), one each time; \"nothing\" takes "
                   "care of all; default: as the record says")
      ->type_name("WHAT")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  analyze->add_flag("--effects", analysis.effects,
                    "S, K and S - K with all three taken care of, and with each kept, side by side");
  analyze->add_flag("--json", analysis.json,
                    "JSON instead of a table; names as in the record, null where absent");
  analyze->footer(
      "Examples:\n"
      "  stickslip analyze pull.h5 --effects                what spikes, drift and the first slip do to S - "
      "K\n"
      "  stickslip analyze pull.h5 --keep spikes --keep drift --json");
  choose(*analyze, chosen, [kept] { return run_analyze(*kept); });
}

void add_characterise(CLI::App& app, Chosen& chosen) {
  const auto kept = std::make_shared<CharacteriseCommand>();
  CharacteriseCommand& characterisation = *kept;
  CLI::App* characterise =
      app.add_subcommand("characterise", "omega and gamma of the tester from its ring-downs");
  characterise->add_option("files", characterisation.files, "records of ring-downs")
      ->required()
      ->type_name("FILE.h5");
  characterise
      ->add_option("-o,--output", characterisation.output, "where to keep it, a file that does not exist")
      ->type_name("FILE.toml");
  characterise->add_flag("--json", characterisation.json, "JSON instead of a table");
  characterise->footer(
      "Examples:\n"
      "  stickslip characterise ring-down-1.h5 ring-down-2.h5 -o tester.toml\n"
      "  stickslip analyze records/*.h5 --tester tester.toml");
  choose(*characterise, chosen, [kept] { return run_characterise(*kept); });
}

}  // namespace

void add_analysing_commands(CLI::App& app, Chosen& chosen) {
  add_analyze(app, chosen);
  add_characterise(app, chosen);
}

}  // namespace stickslip::cli
