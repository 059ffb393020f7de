#include <fmt/format.h>

#include <string>

#include "apps/commands.h"
#include "apps/extras.h"

namespace touchstone::apps {
namespace {

// The options and subcommands of one command, as words.
std::string words_of(const CLI::App& command) {
  std::string words;
  for (const auto* option : command.get_options()) {
    for (const auto& name : option->get_lnames()) words += " --" + name;
  }
  for (const auto* inner : command.get_subcommands([](const CLI::App*) { return true; }))
    words += " " + inner->get_name();
  return words;
}

// Files are offered wherever a word does not start with a dash, since most options take one.
std::string bash_script(const CLI::App& program) {
  std::string cases, extras;
  std::vector<std::string> names;
  for (const auto* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
    cases += fmt::format("    {}) words=\"{}\" ;;\n", command->get_name(), words_of(*command).substr(1));
  }
  for (const Extra& extra : find_extras(names)) extras += " " + extra.name;
  return fmt::format(R"sh(# bash completion for touchstone: eval "$(touchstone completion bash)"
_touchstone() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} words="{}"
  [ "$COMP_CWORD" -gt 1 ] && case ${{COMP_WORDS[1]}} in
{}  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
  [ "$COMP_CWORD" -gt 1 ] && [ "${{current#-}}" = "$current" ] && COMPREPLY+=($(compgen -f -- "$current"))
}}
complete -o filenames -F _touchstone touchstone
)sh",
                     words_of(program).substr(1) + extras, cases);
}

}  // namespace

void add_completion(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand("completion", "Print the completion script of a shell");
  auto* const bash =
      command->add_subcommand("bash", "for bash; zsh reads it after: autoload -U bashcompinit; bashcompinit");
  command->require_subcommand(1);
  command->footer("Example:\n  echo 'eval \"$(touchstone completion bash)\"' >> ~/.bashrc");
  bash->callback([&program, &run] {
    run = [&program] {
      fmt::print("{}", bash_script(program));
      return ExitStatus::passed;
    };
  });
}

}  // namespace touchstone::apps
