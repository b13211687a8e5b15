"""The workbench: change a method's options and see at once what happens to all boats.

`form` makes controls of the model of a method, `bench` answers questions as plain data, `server`
listens on loopback; the page itself is `templates/` and `static/`. Numbers come from `pipeline` by
way of `warehouse.queries.scenario`, charts from `dashboards.figures`.
"""
