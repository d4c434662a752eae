"""jfto sim explains wrong arguments."""

import pytest

from jfto.cli.main import main


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (("--home", "here"), "--home"),
        (("--home", "47.4,8.5"), "--home"),
        (("--param", "WPNAV_SPEED"), "--param"),
        (("--param", "NO_SUCH=1"), "NO_SUCH"),
        (("--fault", "gps 9 off"), "vehicle 9"),
        (("--speedup", "0"), "speedup"),
        (("--to", "nowhere"), "Endpoint"),
        (("--vehicles", "500"), "500"),
    ],
)
def test_wrong_arguments_are_explained(arguments, word, capsys):
    """Exit status 2 and a message that names what is wrong."""
    assert main(["sim", "--host", "127.0.0.1", *arguments]) == 2
    assert word in capsys.readouterr().err
