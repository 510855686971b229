// The command `trilens`.
#include "cli/command.h"

int main(int argc, char** argv) {
    return trilens::run_command_line(argc, argv);
}
