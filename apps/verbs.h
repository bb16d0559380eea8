#pragma once
#include "apps/run.h"

#include <string>
#include <vector>

/// What the verbs of the command do; each returns the exit code.
namespace apps {

int run_verb(const std::string& scene, const std::string& resume, const std::string& packing,
             RunOptions options);
int check_verb(const std::string& scene, const std::vector<std::string>& overrides);
int pack_verb(const std::string& scene, const std::string& output,
              const std::vector<std::string>& overrides);
int new_verb(const std::string& kind);
int plot_verb(const std::vector<std::string>& results, const std::string& output);
int report_verb(const std::vector<std::string>& results, const std::string& output);
int picture_verb(const std::string& result, const std::string& output, const std::string& time,
                 double magnify);
int keys_verb();
int export_verb(const std::string& result, const std::string& table, const std::string& time);
int info_verb(const std::string& file);

} // namespace apps
