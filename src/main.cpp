// The command `trilens`.
#include "cli/commands.h"

int main(int argc, char** argv) {
    return trilens::run_program(trilens::make_commands(), argc, argv);
}
