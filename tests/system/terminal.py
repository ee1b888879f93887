"""What a program shows at a terminal."""

import os
import pty
import subprocess


def run_at_a_terminal(command, *, timeout_s, stdout=None, **options):
    """Runs it with a terminal as its standard error and, unless told otherwise, its standard output.

    Returns (bytes shown there, whole: until the terminal has no writer left, code of its exit, standard output if it
    was subprocess.PIPE).
    """
    shown, terminal = pty.openpty()
    with os.fdopen(shown, "rb") as screen:
        try:
            program = subprocess.Popen([str(word) for word in command], stdout=terminal if stdout is None else stdout,
                                       stderr=terminal, **options)
        finally:
            os.close(terminal)
        with program:
            text = b""
            try:
                while part := screen.read1(65536):
                    text += part
            except OSError:  # Linux says EIO at the end of a terminal.
                pass
            output, _ = program.communicate(timeout=timeout_s)
    return text, program.returncode, output
