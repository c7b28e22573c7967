"""Parts that users add: what controllers and stages are, and how they are found by name.

A part is a class of your own. A world, an option or every summary names it:

    kind           entry point group     named by            methods
    controller     physim.controllers    --controller NAME   decide(observation, memory)
    sensing stage  physim.sensing        sensing.stages:     start(scene), sense(scene, truth, ...)
    filter         physim.filters        filters:            start(scene), filter(scene, ...)
    disturbance    physim.disturbances   disturbances:       start(scene), disturb(scene, ...)
    observer       physim.observers      --observer NAME     start, after_step(step), close(ended)
    metric         physim.metrics        every summary       measure(record)
    plot           physim.plots          physim plot --only  draw(record)

``--controller module:Class`` and ``--observer module:Class`` take a class from a file in the
current folder; ``physim new --project DIR`` writes an example. All other parts have a name: the
``pyproject.toml`` of your package gives it, and ``pip install --editable .`` registers it::

    [project.entry-points."physim.filters"]
    ramp = "my_module:Ramp"

``physim list`` then shows the name, and worlds may say ``filters: [{type: ramp}]``. The ``measure``
of a metric returns a value, or one for each robot; the ``draw`` of a plot a matplotlib figure.

What each method gets and returns: ``help("physim.parts.controller")`` for controllers,
``help("physim.parts.stages")`` for stages and observers.
"""
