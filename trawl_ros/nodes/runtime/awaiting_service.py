"""Service whose answer is awaited, for executors that know no coroutines.

The events executor takes a message in a tenth of the time that others need, but answers a request
before it takes the next message. So this service stays out of an executor's sight: a timer takes
its requests, and asks the coroutines that answer them whether they are done.
"""

from collections.abc import Callable, Coroutine
from typing import Any

from rclpy.service import Service

PERIOD_S = 0.1
"""Period at which requests are taken, and coroutines asked."""

Answer = Callable[[Any, Any], Coroutine[Any, Any, Any]]


class AwaitingService:
    """Answers of a service that no executor sees.

    Parameters
    ----------
    service
        Of a node that does not list it among its services.
    answer
        Coroutine function from request and response to the response; raises nothing.
    """

    def __init__(self, service: Service, answer: Answer) -> None:
        self._service, self._answer = service, answer
        self._pending: list[tuple[Coroutine[Any, Any, Any], Any]] = []

    def go_on(self) -> None:
        """Take a request, where there is one, and send the answers that are there."""
        kind, handle = self._service.srv_type, self._service.handle
        with handle:
            request, header = handle.service_take_request(kind.Request)
        if header is not None:
            self._pending.append((self._answer(request, kind.Response()), header))
        for one in tuple(self._pending):
            coroutine, header = one
            try:
                coroutine.send(None)
            except StopIteration as end:
                self._pending.remove(one)
                self._service.send_response(end.value, header)
