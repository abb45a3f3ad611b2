// SPDX-License-Identifier: Apache-2.0
#include "app/cli/commands.h"
#include <CLI/CLI.hpp>

using namespace lightloom;

int main(int argc, char** argv)
{
    CLI::App app("Lightloom: indirect light, baked, measured and exported without a window");
    cli::Context context;
    app.add_flag("--json", context.json, "Machine-readable output");
    app.require_subcommand(1);
    CLI::App* params = app.add_subcommand("params", "List every bake parameter");
    params->fallthrough();
    CLI11_PARSE(app, argc, argv);
    if (params->parsed()) return cli::params(context);
    return cli::kUsage;
}
