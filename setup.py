# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Build of the ROS 2 package trawl_ros; the only place that declares dependencies for pip."""

from pathlib import Path
from runpy import run_path

from setuptools import find_packages, setup

PACKAGE = 'trawl_ros'

NODES = (
    'sim_node',
    'winch_node',
    'door_sensor_node',
    'trawl_sonar_node',
    'vessel_node',
    'autotrawl_node',
    'autopilot_node',
    'trial_node',
    'identification_node',
    'discrepancy_node',
    'bag_recorder',
    'bag_player',
    'nmea_in',
    'nmea_out',
    'foxglove_node',
    'view_node',
    'tether_node',
)

# What a full ROS 2 (Ubuntu 24.04) gives by the rosdep keys that package.xml names.
BY_ROSDEP = {
    'click>=8.1,<9': 'python3-click',
    'matplotlib>=3.6,<4': 'python3-matplotlib',
    'numpy>=1.26,<3': 'python3-numpy',
    'psutil>=5.9,<8': 'python3-psutil',
    'PyYAML>=6,<7': 'python3-yaml',
    'rich>=13,<16': 'python3-rich',
    'scipy>=1.11,<2': 'python3-scipy',
}

# What has no rosdep key, or is too old there: the README's line of pip, which tests hold to this.
# Lower bounds exclude versions with published holes.
BY_PIP = [
    'cma>=4.0,<5',
    'cryptography>=42.0.4,<60',
    'dask>=2024.8,<2027',
    'distributed>=2024.8,<2027',
    'google-re2>=1.1.20240702,<2',
    'gsw>=3.6,<4',
    'jinja2>=3.1.6,<4',
    'lz4>=4,<5',
    'mcap>=1.6,<1.7',
    'numba>=0.60,<1',
    'pydantic>=2.7,<3',
    'pynmeagps>=1.1,<2',
    'rosbags>=0.11.9,<0.12',
    'zstandard>=0.22,<1',
]

# ROS 2 itself, for machines that do not have it. It is an extra because a machine with a full
# ROS 2 brings rclpy and the message packages along, and a second copy of them from the package
# index would hide the one that the rest of that machine was built against.
ROS = [
    f'ros-jazzy-{name}'
    for name in (
        'ament-index-python>=1.8,<2',
        'diagnostic-msgs>=5.3,<6',
        'geometry-msgs>=5.3,<6',
        'nav-msgs>=5.3,<6',
        'rcl-interfaces>=2,<3',
        'rclpy>=7.1,<8',
        'rmw-fastrtps-cpp>=8.4,<9',
        'rosgraph-msgs>=2,<3',
        'sensor-msgs>=5.3,<6',
        'std-msgs>=5.3,<6',
        'std-srvs>=5.3,<6',
        'visualization-msgs>=5.3,<6',
    )
]

# The same of Kilted, to try by hand: both distributions pull one ros-rclpy, so name one only.
KILTED = [
    f'ros-kilted-{name}'
    for name in (
        'ament-index-python>=1.11,<2',
        'diagnostic-msgs>=5.5,<6',
        'geometry-msgs>=5.5,<6',
        'nav-msgs>=5.5,<6',
        'rcl-interfaces>=2.3,<3',
        'rclpy>=9.1,<10',
        'rmw-fastrtps-cpp>=9.3,<10',
        'rosgraph-msgs>=2.3,<3',
        'sensor-msgs>=5.5,<6',
        'std-msgs>=5.5,<6',
        'std-srvs>=5.5,<6',
        'visualization-msgs>=5.5,<6',
    )
]

TEST = [
    'colcon-bash>=0.5,<1',
    'colcon-core>=0.18,<1',
    'colcon-package-information>=0.4,<1',
    # `colcon build --packages-select`, as the README has it.
    'colcon-package-selection>=0.2,<1',
    'colcon-ros>=0.5,<1',
    'hypothesis>=6.100,<7',
    'markdown-it-py>=3,<5',
    'import-linter>=2.6,<3',
    'mypy>=1.13,<3',
    'nox>=2024.10.9,<2027',
    'pymarkdownlnt>=0.9.35,<0.10',
    'pytest>=7.4,<10',
    'pytest-cov>=6,<8',
    'pytest-timeout>=2.3,<3',
    'pytest-xdist>=3.6,<4',
    'ruff>=0.8,<1',
    # setup.py is still run as a command by colcon, which setuptools 80 gave up.
    'setuptools>=78.1.1,<80',
    'types-PyYAML>=6,<7',
    'uv>=0.5,<1',
]

# The site of `make docs`; tests build it, since a warning fails it.
DOCS = [
    'mkdocs>=1.6,<2',
    'mkdocs-material>=9.6,<10',
    'mkdocstrings-python>=1.16,<3',
]

# Other programs that `trawl validate` and `trawl benchmark` are held against.
PEERS = [
    'moordyn>=2.7,<2.8',
    'MoorPy>=1.3,<1.4',
    'trawlkit>=1.1,<1.2',
]

# For people who look on, of whom aboard there are none: a small library and one of 170 MB.
# Tests that need the larger one are skipped without it.
FOXGLOVE = ['websockets>=14,<18']
VIEW = [*FOXGLOVE, 'rerun-sdk>=0.39,<0.42']


def tree(folder: str) -> list[tuple[str, list[str]]]:
    """All files below `folder`, to be installed in the same sub-folders of the share folder."""
    folders: dict[Path, list[str]] = {}
    for file in sorted(Path(folder).rglob('*')):
        if file.is_file() and not any(part.startswith('.') for part in file.parts):
            folders.setdefault(file.parent, []).append(str(file))
    return [(f'share/{PACKAGE}/{parent.as_posix()}', files) for parent, files in folders.items()]


setup(
    name=PACKAGE,
    version=run_path(f'{PACKAGE}/core/version.py')['__version__'],
    description='Emulates the instruments of a mid-water trawler and refits the model of its gear',
    license='Apache-2.0',
    maintainer='trawl_ros developers',
    maintainer_email='trawl_ros@example.org',
    python_requires='>=3.11',
    packages=find_packages(include=[PACKAGE, f'{PACKAGE}.*']),
    package_data={PACKAGE: ['py.typed', '**/templates/*.j2']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{PACKAGE}']),
        (f'share/{PACKAGE}', ['package.xml']),
        *tree('config'),
        *tree('bags'),
        *tree('launch'),
    ],
    install_requires=[*BY_ROSDEP, *BY_PIP],
    extras_require={
        'ros': ROS,
        'ros-kilted': KILTED,
        'view': VIEW,
        'test': [*TEST, *DOCS, *PEERS, *FOXGLOVE],
        'docs': DOCS,
        'peers': PEERS,
    },
    entry_points={
        'console_scripts': [
            *(f'{node} = {PACKAGE}.nodes.starting:{node}' for node in NODES),
            f'trawl = {PACKAGE}.cli.main:main',
        ],
        # Named as the module: `-p trawl_ros.testing` then loads it once.
        'pytest11': [f'{PACKAGE}.testing = {PACKAGE}.testing'],
    },
    zip_safe=False,
)
