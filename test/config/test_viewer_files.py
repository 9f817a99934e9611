"""The files for RViz, Foxglove and PlotJuggler name what there is, in words these programs know.

The programs are not installed with the tests. What they know was taken from their sources: RViz 2
(`rviz_default_plugins/plugins_description.xml` and the displays' properties, of October 2024),
Lichtblick, the open continuation of Foxglove Studio (`suite-base/src/panels`, of August 2026), and
PlotJuggler 3.17 (`plotwidget.cpp`, `plot_docker.cpp`, `ParserROS/ros_parser.cpp`).
"""

import json
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from typing import Any

import pytest
import yaml

from trawl_ros.core.resources import share_path
from trawl_ros.messages.cdr import STORE
from trawl_ros.records.topics import MAP, NAMESPACE, TOPICS, WINCH_NAMES, absolute

BY_FULL_NAME = {absolute(name): topic for name, topic in TOPICS.items()}

TOPIC = {'Depth', 'Durability Policy', 'History Policy', 'Reliability Policy', 'Value'}
FILTERED_TOPIC = TOPIC | {'Filter size'}
DISPLAY = {'Class', 'Enabled', 'Name', 'Value'}
ARROW = {'Color', 'Alpha', 'Shaft Length', 'Shaft Radius', 'Head Length', 'Head Radius',
         'Axes Length', 'Axes Radius'}  # fmt: skip
RVIZ_DISPLAYS: dict[str, tuple[str | None, set[str]]] = {
    'Grid': (None, {'Alpha', 'Cell Size', 'Color', 'Line Style', 'Normal Cell Count', 'Offset',
                    'Plane', 'Plane Cell Count', 'Reference Frame'}),
    'MarkerArray': ('visualization_msgs/msg/MarkerArray', {'Namespaces', 'Topic'}),
    'Polygon': ('geometry_msgs/msg/PolygonStamped', {'Alpha', 'Color', 'Topic'}),
    'Odometry': ('nav_msgs/msg/Odometry', {'Angle Tolerance', 'Covariance', 'Keep',
                                           'Position Tolerance', 'Shape', 'Topic'}),
    'Pose': ('geometry_msgs/msg/PoseStamped', {'Shape', 'Topic', *ARROW}),
    'PointCloud2': ('sensor_msgs/msg/PointCloud2', {
        'Alpha', 'Autocompute Intensity Bounds', 'Autocompute Value Bounds', 'Axis',
        'Channel Name', 'Color', 'Color Transformer', 'Decay Time', 'Invert Rainbow', 'Max Color',
        'Max Intensity', 'Min Color', 'Min Intensity', 'Position Transformer', 'Selectable',
        'Size (Pixels)', 'Size (m)', 'Style', 'Topic', 'Use Fixed Frame', 'Use rainbow'}),
    'Image': ('sensor_msgs/msg/Image', {'Max Value', 'Median window', 'Min Value',
                                        'Normalize Range', 'Topic'}),
}  # fmt: skip
"""Message type and properties by class, without those that every display has."""

RVIZ_TOOLS = {'Interact', 'MoveCamera', 'Select', 'FocusCamera', 'Measure'}
RVIZ_VIEWS = {'Orbit', 'TopDownOrtho'}
RVIZ_PANELS = {'Displays', 'Selection', 'Tool Properties', 'Views', 'Time'}

FOXGLOVE_PANELS = {
    '3D': {'cameraState', 'followMode', 'followTf', 'scene', 'transforms', 'topics', 'layers',
           'publish', 'imageMode'},
    'Image': {'cameraState', 'followMode', 'scene', 'transforms', 'topics', 'layers', 'publish',
              'imageMode'},
    'Plot': {'paths', 'showLegend', 'legendDisplay', 'showPlotValuesInLegend', 'showXAxisLabels',
             'showYAxisLabels', 'isSynced', 'xAxisVal', 'sidebarDimension', 'yAxisLabel'},
    'map': {'center', 'customTileUrl', 'disabledTopics', 'followTopic', 'layer', 'topicColors',
            'zoomLevel', 'maxNativeZoom'},
    'DiagnosticSummary': {'minLevel', 'pinnedIds', 'hardwareIdFilter', 'topicToRender',
                          'sortByLevel'},
    'RawMessages': {'diffEnabled', 'diffMethod', 'diffTopicPath', 'showFullMessageForDiff',
                    'topicPath'},
    'Tab': {'activeTabIdx', 'tabs'},
}  # fmt: skip
"""Keys by type of panel; a title may stand beside them."""

FOXGLOVE_3D = {
    'visualization_msgs/msg/MarkerArray': {'visible'},
    'geometry_msgs/msg/PolygonStamped': {'visible', 'lineWidth', 'color'},
    'nav_msgs/msg/Odometry': {'visible', 'type', 'arrowScale', 'color', 'showCovariance'},
    'sensor_msgs/msg/PointCloud2': {'visible', 'pointSize', 'pointShape', 'colorMode', 'colorMap',
                                    'colorField', 'minValue', 'maxValue'},
}  # fmt: skip
FOXGLOVE_MODIFIERS = {'', 'rad2deg', 'negative'}

ANGLES = ('roll', 'pitch', 'yaw')
"""What PlotJuggler adds to a quaternion of the types it knows."""

PLOTJUGGLER_QUATERNIONS = {'sensor_msgs/msg/Imu', 'nav_msgs/msg/Odometry',
                           'geometry_msgs/msg/PoseStamped'}  # fmt: skip


def type_of_field(type_name: str, path: list[str]) -> tuple[Any, ...]:
    """Follow field names (with an index where there is a list) through the message types."""
    name, index = re.fullmatch(r'(\w+)(?:\[(\d+)\])?', path[0]).groups()
    fields = dict(STORE.get_msgdef(type_name).fields)
    assert name in fields, f'{type_name} has no {name}, only {", ".join(fields)}'
    kind, what = fields[name]
    if index is not None:
        assert kind.name in ('ARRAY', 'SEQUENCE'), f'{name} is no list'
        kind, what = what[0]
    if len(path) == 1:
        return kind, what
    assert kind.name == 'NAME', f'{name} has no parts'
    return type_of_field(what, path[1:])


def is_number(type_name: str, path: list[str]) -> bool:
    kind, what = type_of_field(type_name, path)
    return kind.name == 'BASE' and what[0] != 'string'


@pytest.fixture(scope='module')
def rviz() -> dict[str, Any]:
    return yaml.safe_load(share_path('config', 'rviz', 'trawl.rviz').read_text())


def test_rviz_shows_topics_of_the_right_type_with_properties_it_has(rviz):
    shown = set()
    for display in rviz['Visualization Manager']['Displays']:
        package, name = display['Class'].split('/')
        assert package == 'rviz_default_plugins'
        type_name, properties = RVIZ_DISPLAYS[name]
        assert set(display) <= DISPLAY | properties, display['Name']
        assert display['Value'] == display['Enabled']
        if type_name is not None:
            topic = display['Topic']
            filtered = name not in ('MarkerArray', 'Image')
            assert set(topic) == (FILTERED_TOPIC if filtered else TOPIC)
            assert BY_FULL_NAME[topic['Value']].type == type_name
            assert topic['Reliability Policy'] == 'Reliable'
            shown.add(topic['Value'].removeprefix(f'/{NAMESPACE}/'))
    assert shown >= {
        'truth/gear', 'truth/net/mouth', 'truth/door/port/odom', 'truth/door/starboard/odom',
        'truth/vessel/odom', 'sonar/points', 'sonar/image',
    }  # fmt: skip


def test_rviz_needs_no_transform_tree(rviz):
    manager = rviz['Visualization Manager']
    assert manager['Global Options']['Fixed Frame'] == MAP
    for display in manager['Displays']:
        # Markers name their frame themselves, an image has no place.
        if 'Topic' in display and not display['Class'].endswith(('MarkerArray', 'Image')):
            assert BY_FULL_NAME[display['Topic']['Value']].frame == MAP


def test_rviz_knows_its_panels_tools_and_views(rviz):
    manager = rviz['Visualization Manager']
    assert {panel['Class'] for panel in rviz['Panels']} == {f'rviz_common/{n}' for n in RVIZ_PANELS}
    for kind, known in ((manager['Tools'], RVIZ_TOOLS), (_views(manager), RVIZ_VIEWS)):
        assert {entry['Class'].split('/')[1] for entry in kind} <= known
        assert all(entry['Class'].startswith('rviz_default_plugins/') for entry in kind)
    names = {display['Name'] for display in manager['Displays']}
    assert "Sonar's image" in names & set(rviz['Window Geometry'])


def _views(manager: dict[str, Any]) -> list[dict[str, Any]]:
    return [manager['Views']['Current'], *manager['Views']['Saved']]


@pytest.fixture(scope='module')
def foxglove() -> dict[str, Any]:
    return json.loads(share_path('config', 'foxglove', 'trawl.json').read_text())


def test_foxglove_has_each_panel_once_with_the_keys_it_needs(foxglove):
    assert set(foxglove) == {
        'configById', 'globalVariables', 'userNodes', 'playbackConfig', 'layout',
    }  # fmt: skip
    panels = foxglove['configById']
    for name, panel in panels.items():
        assert set(panel) - {'foxglovePanelTitle'} == FOXGLOVE_PANELS[name.split('!')[0]], name
    placed = list(_leaves(foxglove['layout']))
    for name in placed:
        for tab in panels[name].get('tabs', []):
            placed += _leaves(tab['layout'])
    assert sorted(placed) == sorted(panels)
    kinds = {name.split('!')[0] for name in panels}
    assert kinds >= {'3D', 'Image', 'Plot', 'DiagnosticSummary', 'RawMessages'}


def _leaves(node: Any) -> Iterator[str]:
    if isinstance(node, str):
        yield node
        return
    assert set(node) == {'first', 'second', 'direction', 'splitPercentage'}
    assert node['direction'] in ('row', 'column')
    yield from _leaves(node['first'])
    yield from _leaves(node['second'])


def test_foxglove_plots_numbers_that_the_messages_have(foxglove):
    plots = {k: v for k, v in foxglove['configById'].items() if k.startswith('Plot!')}
    assert len(plots) >= 6
    for name, plot in plots.items():
        assert plot['yAxisLabel'], name
        for path in plot['paths']:
            value, _, modifier = path['value'].partition('.@')
            topic, _, fields = value.partition('.')
            assert modifier in FOXGLOVE_MODIFIERS
            known = BY_FULL_NAME[topic]
            assert is_number(known.type, fields.split('.')), path['value']
            assert path['timestampMethod'] == 'headerStamp'
            assert 'header' in dict(STORE.get_msgdef(known.type).fields)


def test_foxglove_s_winches_are_in_the_order_of_their_names(foxglove):
    for name in ('Plot!length', 'Plot!tension'):
        for path in foxglove['configById'][name]['paths']:
            index = int(re.search(r'\[(\d)\]$', path['value']).group(1))
            assert WINCH_NAMES[index].startswith(path['label'].split(',')[0])


def test_foxglove_looks_at_topics_in_map(foxglove):
    panels = foxglove['configById']
    scene = panels['3D!gear']
    assert scene['followTf'] == MAP
    for name, settings in scene['topics'].items():
        topic = BY_FULL_NAME[name]
        assert set(settings) == FOXGLOVE_3D[topic.type]
        assert topic.frame == MAP or topic.name == 'truth/gear'
    image = panels['Image!sonar']['imageMode']['imageTopic']
    assert BY_FULL_NAME[image].type == 'sensor_msgs/msg/Image'
    assert BY_FULL_NAME[panels['map!track']['followTopic']].type == 'sensor_msgs/msg/NavSatFix'
    assert panels['DiagnosticSummary!nodes']['topicToRender'] in BY_FULL_NAME
    assert panels['RawMessages!estimate']['topicPath'] in BY_FULL_NAME


@pytest.fixture(scope='module')
def plotjuggler() -> ET.Element:
    return ET.fromstring(share_path('config', 'plotjuggler', 'trawl.xml').read_text())


def test_plotjuggler_s_tabs_are_nested_as_it_reads_them(plotjuggler):
    (tabbed,) = plotjuggler.findall('tabbed_widget')
    assert tabbed.attrib == {'name': 'Main Window', 'parent': 'main_window'}
    tabs = tabbed.findall('Tab')
    assert int(tabbed.find('currentTabIndex').get('index')) < len(tabs) >= 4
    for tab in tabs:
        (splitter,) = tab.findall('Container/DockSplitter')
        areas = splitter.findall('DockArea')
        assert len(areas) == int(splitter.get('count')) == len(splitter.get('sizes').split(';'))
        assert splitter.get('orientation') in ('|', '-')
        for area in areas:
            assert ' / ' in area.get('name')
            (plot,) = area.findall('plot')
            assert plot.get('mode') == 'TimeSeries'
            assert plot.findall('curve')
            for transform in plot.findall('curve/transform'):
                assert transform.get('name') == 'Scale/Offset'
                (options,) = transform.findall('options')
                for key in ('time_offset', 'value_offset', 'value_scale'):
                    float(options.get(key))


def test_plotjuggler_s_curves_are_named_as_its_parser_names_them(plotjuggler):
    curves = [curve.get('name') for curve in plotjuggler.iter('curve')]
    assert len(curves) == len(set(curves)) > 30
    for curve in curves:
        name = max((name for name in BY_FULL_NAME if curve.startswith(f'{name}/')), key=len)
        kind, path = BY_FULL_NAME[name].type, curve.removeprefix(f'{name}/').split('/')
        if kind == 'sensor_msgs/msg/JointState':
            joint, field = path
            assert joint in WINCH_NAMES
            assert field in ('position', 'velocity', 'effort')
        elif path[-1] in ANGLES and kind in PLOTJUGGLER_QUATERNIONS:
            _, what = type_of_field(kind, path[:-1])
            assert what == 'geometry_msgs/msg/Quaternion'
        else:
            assert is_number(kind, path), curve


def test_plotjuggler_turns_pressure_into_the_depth_of_sea_water(plotjuggler):
    from trawl_ros.model.water import Water

    pressures = [c for c in plotjuggler.iter('curve') if c.get('name').endswith('fluid_pressure')]
    assert len(pressures) == 3
    for curve in pressures:
        options = curve.find('transform/options')
        scale, offset = (float(options.get(key)) for key in ('value_scale', 'value_offset'))
        assert scale * Water().pressure(100.0) + offset == pytest.approx(100.0, abs=0.001)
