"""A real browser without a window: Chromium, driven by its DevTools protocol."""

import base64
import io
import json
import os
import shutil
import subprocess
import time
from pathlib import Path
from urllib.request import urlopen

import numpy as np
from PIL import Image
from websockets.sync.client import connect

PROGRAMS = ('chromium', 'chromium-browser', 'google-chrome')
PROGRAM = next(filter(None, map(shutil.which, PROGRAMS)), None)
MISSING = 'no Chromium for the page: apt-get install chromium'

SIZE = 1280, 720
STARTS_S = 60.0
ANSWERS_S = 120.0

SETTINGS = (
    '--headless=new',
    '--remote-debugging-port=0',
    '--no-first-run',
    '--disable-background-networking',
    '--disable-component-update',
    # Pictures are drawn by the processor.
    '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader',
)


class Browser:
    """Browser with one page while entered.

    Attributes
    ----------
    asked, refused : set of str
        Addresses that the page has asked for, and those of which the browser held it back, by the
        policy that came with the page.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._number = 0
        self.asked, self.refused = set(), set()
        self._addresses = {}
        self._loaded = False

    def __enter__(self) -> 'Browser':
        # Chromium's sandbox is not to be had by root, as whom containers run tests.
        own = ['--no-sandbox'] if os.geteuid() == 0 else []
        self._process = subprocess.Popen(
            [PROGRAM, *SETTINGS, *own, f'--user-data-dir={self._folder}', 'about:blank'],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            self._line = connect(self._page(), max_size=None).__enter__()
        except BaseException:
            self._process.kill()
            self._process.wait()
            raise
        self.call('Page.enable')
        self.call('Network.enable')
        width, height = SIZE
        self.call(
            'Emulation.setDeviceMetricsOverride',
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )
        return self

    def __exit__(self, *_: object) -> None:
        self._line.__exit__(None, None, None)
        self._process.terminate()
        try:
            self._process.wait(10.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def open(self, address: str) -> None:
        """Go to an address, and wait until its page is there."""
        self._loaded = False
        answer = self.call('Page.navigate', url=address)
        assert 'errorText' not in answer, answer['errorText']
        while not self._loaded:
            self._take(json.loads(self._line.recv(timeout=ANSWERS_S)))

    def ask(self, script: str) -> object:
        """Return what JavaScript in the page comes to, also where it has to wait for it."""
        answer = self.call(
            'Runtime.evaluate', expression=script, returnByValue=True, awaitPromise=True
        )
        assert 'exceptionDetails' not in answer, answer['exceptionDetails']
        return answer['result'].get('value')

    def picture(self) -> np.ndarray:
        """Pixels (rows, columns, 3) of the page."""
        data = base64.b64decode(self.call('Page.captureScreenshot', format='png')['data'])
        return np.asarray(Image.open(io.BytesIO(data)).convert('RGB')).astype(int)

    def call(self, method: str, **parameters: object) -> dict:
        """Call a method of the protocol; events that come before its answer are noted."""
        self._number += 1
        wish = {'id': self._number, 'method': method, 'params': parameters}
        self._line.send(json.dumps(wish))
        while True:
            said = json.loads(self._line.recv(timeout=ANSWERS_S))
            if said.get('id') == self._number:
                assert 'error' not in said, said['error']
                return said['result']
            self._take(said)

    def _take(self, said: dict) -> None:
        event, about = said['method'], said['params']
        if event == 'Page.loadEventFired':
            self._loaded = True
        elif event == 'Network.requestWillBeSent':
            address = about['request']['url']
            self.asked.add(address)
            self._addresses[about['requestId']] = address
        elif event == 'Network.loadingFailed' and about.get('blockedReason') == 'csp':
            self.refused.add(self._addresses[about['requestId']])

    def _page(self) -> str:
        """Address of the protocol for its first page."""
        port = self._folder / 'DevToolsActivePort'
        end = time.monotonic() + STARTS_S
        while True:
            assert self._process.poll() is None, f'{PROGRAM} has ended'
            assert time.monotonic() < end, f'{PROGRAM} does not start'
            time.sleep(0.1)
            if port.exists() and '\n' in (text := port.read_text()):
                pages = json.load(urlopen(f'http://127.0.0.1:{text.split()[0]}/json/list'))
                for page in pages:
                    if page['type'] == 'page':
                        return page['webSocketDebuggerUrl']
