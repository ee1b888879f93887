"""What a program shows at a terminal."""

import os
import pty
import subprocess
import threading


def drain(screen, parts):
    """Until the terminal has no writer left, of which Linux says EIO."""
    try:
        while part := os.read(screen, 65536):
            parts.append(part)
    except OSError:
        pass


def run_at_a_terminal(command, *, timeout_s, stdout=None, **options):
    """Runs it with a terminal as its standard error and, unless told otherwise, its standard output.

    Returns (bytes shown there, whole: until the terminal has no writer left, code of its exit, standard output if it
    was subprocess.PIPE). A program that does not end in time is killed: subprocess.TimeoutExpired.
    """
    screen, terminal = pty.openpty()
    parts = []
    # Beside the wait: a terminal, as a pipe, holds so much only, and the program would wait for its reader.
    reader = threading.Thread(target=drain, args=(screen, parts), daemon=True)
    try:
        try:
            program = subprocess.Popen([str(word) for word in command], stdout=terminal if stdout is None else stdout,
                                       stderr=terminal, **options)
        finally:
            os.close(terminal)
        reader.start()
        with program:
            try:
                output, _ = program.communicate(timeout=timeout_s)
            except subprocess.TimeoutExpired:
                program.kill()
                raise
            finally:
                # Not for ever: a child that outlives the program may have the terminal still.
                reader.join(timeout_s)
    finally:
        os.close(screen)
    return b"".join(parts), program.returncode, output
