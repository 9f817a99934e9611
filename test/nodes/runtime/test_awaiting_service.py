"""A coroutine answers a service when it ends; what goes on meanwhile, goes on."""

import time

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.run import NodeExecutor  # noqa: E402

pytestmark = pytest.mark.ros


class Waiting:
    """What a coroutine can wait for."""

    def __init__(self):
        self.over = False

    def __await__(self):
        while not self.over:
            yield


class Asked(TrawlNode):
    def __init__(self, **kwargs):
        super().__init__('asked', **kwargs)
        self.waiting, self.beats, self.requests = Waiting(), 0, 0
        self.offer_awaiting('finish', self._finish)
        self.every(0.02, self._beat)

    def _beat(self):
        self.beats += 1

    async def _finish(self, request, response):
        self.requests += 1
        if self.requests == 1:
            raise ValueError('the first is not understood')
        await self.waiting
        response.success, response.message = True, 'done'
        return response


@pytest.fixture(params=[NodeExecutor, SingleThreadedExecutor])
def spinning(request):
    context = rclpy.Context()
    rclpy.init(args=[], context=context)
    node, executor = Asked(context=context), request.param(context=context)
    executor.add_node(node)

    def until(condition):
        end = time.monotonic() + 20.0
        while not condition():
            assert time.monotonic() < end, 'it does not come about'
            executor.spin_once(timeout_sec=0.05)

    yield node, until
    node.destroy_node()
    executor.shutdown()
    rclpy.shutdown(context=context)


def test_an_answer_is_awaited_while_all_else_goes_on(spinning):
    node, until = spinning
    client = node.create_client(Trigger, 'finish')
    until(client.service_is_ready)
    refused = client.call_async(Trigger.Request())
    until(refused.done)
    assert not refused.result().success
    assert 'the first' in refused.result().message
    asked = [client.call_async(Trigger.Request()) for _ in range(2)]
    until(lambda: node.requests == 3)
    before = node.beats
    until(lambda: node.beats > before + 5)
    assert not any(answer.done() for answer in asked)
    node.waiting.over = True
    until(lambda: all(answer.done() for answer in asked))
    assert [answer.result().message for answer in asked] == ['done', 'done']
