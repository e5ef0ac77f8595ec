//! The console: pages for people on the side port, out of the binary, with nothing fetched from anywhere else.
//!
//! | path | what |
//! |---|---|
//! | `/`, `/console/` | the pages: plan a move, go through points, look on at streams |
//! | `/console/api/motion.v1.<Service>/<Method>` | the same methods as over gRPC, in the proto3 JSON of their messages |
//!
//! - [`api`]: the methods; a handler reads JSON, calls the gRPC service, and writes JSON
//! - [`events`]: streams as server-sent events, many over one connection
//! - [`guard`]: who may ask: pages of this server, and no other site's

mod api;
mod events;
mod guard;

use serving::axum::Router;
use serving::axum::extract::DefaultBodyLimit;
use serving::axum::http::header;
use serving::axum::middleware::from_fn_with_state;
use serving::axum::response::{IntoResponse as _, Redirect, Response};
use serving::axum::routing::get;
use serving::{Caller, Leaving};

use crate::rpc::{Planner, Setpoints};
use crate::watch::Board;
use guard::Hosts;

/// The files of the pages: name, type, contents.
const FILES: [(&str, &str, &str); 15] = [
    ("", HTML, include_str!("page/index.html")),
    ("style.css", "text/css; charset=utf-8", include_str!("page/style.css")),
    ("icon.svg", "image/svg+xml", include_str!("page/icon.svg")),
    ("main.js", SCRIPT, include_str!("page/main.js")),
    ("api.js", SCRIPT, include_str!("page/api.js")),
    ("card.js", SCRIPT, include_str!("page/card.js")),
    ("chart.js", SCRIPT, include_str!("page/chart.js")),
    ("explorer.js", SCRIPT, include_str!("page/explorer.js")),
    ("form.js", SCRIPT, include_str!("page/form.js")),
    ("history.js", SCRIPT, include_str!("page/history.js")),
    ("live.js", SCRIPT, include_str!("page/live.js")),
    ("motion.js", SCRIPT, include_str!("page/motion.js")),
    ("panel.js", SCRIPT, include_str!("page/panel.js")),
    ("points.js", SCRIPT, include_str!("page/points.js")),
    ("units.js", SCRIPT, include_str!("page/units.js")),
];
const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Nothing but what this server hands out is run, shown or asked, and no other site frames it.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// What the console stands on.
#[derive(Clone, Debug)]
pub(crate) struct Console {
    pub(crate) planner: Planner,
    pub(crate) setpoints: Setpoints,
    pub(crate) board: Board,
    pub(crate) leaving: Leaving,
    /// Nobody who comes here says who he is: he may what the policy grants to those without a name.
    pub(crate) caller: Caller,
}

impl Console {
    /// Its pages, under any IP address, `localhost` and the names in `hosts`; bodies of at most `most_bytes`.
    pub(crate) fn pages(self, hosts: &[String], most_bytes: usize) -> Router {
        let api = api::routes().layer(DefaultBodyLimit::max(most_bytes)).with_state(self);
        let pages = FILES.into_iter().fold(api, |router, (name, kind, text)| {
            router.route(&format!("/console/{name}"), get(move || std::future::ready(page(kind, text))))
        });
        let home = || std::future::ready(Redirect::permanent("/console/"));
        let pages = pages.route("/", get(home)).route("/console", get(home));
        pages.layer(from_fn_with_state(Hosts::named(hosts), guard::admit))
    }
}

fn page(kind: &'static str, text: &'static str) -> Response {
    let headers = [
        (header::CONTENT_TYPE, kind),
        // Of the version that is running: the next one may say something else under the same name.
        (header::CACHE_CONTROL, "no-cache"),
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
    ];
    (headers, text).into_response()
}
