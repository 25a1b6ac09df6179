// SPDX-License-Identifier: MIT
// The flotilla command: arguments and exit codes. Everything it does goes through the public headers.
#include <CLI/CLI.hpp>

int main(int argc, char** argv) {
    CLI::App app{"flotilla: interpenetration-free rigid bodies without thickness"};
    app.require_subcommand(1);
    CLI11_PARSE(app, argc, argv);
    return 0;
}
