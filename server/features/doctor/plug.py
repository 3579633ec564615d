"""The plug of the doctor."""

from collections.abc import Coroutine, Sequence
from typing import Any

from server.feature import Plug
from server.features.doctor.examination import Examination


class DoctorPlug(Plug):
    """The plug that examines the computer at the server's start."""

    def __init__(self, examination: Examination) -> None:
        self._examination = examination

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Examine the computer once."""
        return (self._examination.at_start(),)
