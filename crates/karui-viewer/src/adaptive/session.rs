//! A session over a control mesh.

use super::faces::Faces;
use super::options::{SmoothOptions, check};
use crate::live::{
    FLAG_COMPLETE, FLAG_RESET, FLAG_TRUNCATED, Frame, Header, Kind, LiveError, Order, Request,
    Result, Session,
};
use karui::PolyMesh;
use karui::progress::Silent;
use karui::subdiv::adaptive::{Adaptive, AdaptiveMesh, View};
use karui::subdiv::{ControlMesh, Rules, SubdivOptions, SurfaceOptions, subdivide};
use std::time::Instant;

/// One page's view of a control mesh.
#[derive(Debug)]
pub struct AdaptiveSession<'a> {
    control: &'a ControlMesh,
    /// What is kept from frame to frame, and the rules that it is for.
    adaptive: Option<(Rules, Adaptive)>,
    /// The surface that is the same from everywhere, and what was asked for.
    uniform: Option<(SmoothOptions, PolyMesh)>,
    mesh: AdaptiveMesh,
    faces: Faces,
    order: Order,
}

impl<'a> AdaptiveSession<'a> {
    /// Starts with nothing sent.
    #[must_use]
    pub fn new(control: &'a ControlMesh) -> Self {
        Self {
            control,
            adaptive: None,
            uniform: None,
            mesh: AdaptiveMesh::default(),
            faces: Faces::new(),
            order: Order::default(),
        }
    }

    /// The mesh that was asked for with this message; whether it is complete.
    fn refine(&mut self, request: &Request<SmoothOptions>) -> Result<bool> {
        check(&request.options.how)?;
        let (camera, lights) = request.view()?;
        let most = request.budget.resolve()?.triangles;
        let Some(how) = request.options.how.adaptive(most.map(|t| t / 2)) else {
            self.surface(request.options)?;
            return Ok(true);
        };
        let view = View {
            camera,
            size: request.size,
            lights,
        };
        let rules = request.options.rules(self.control.rules);
        let mut adaptive = match self.adaptive.take() {
            Some((known, adaptive)) if known == rules => adaptive,
            _ => {
                // What the page does not draw needs no vertices of its own.
                let plain = ControlMesh {
                    rules,
                    uvs: None,
                    colors: None,
                    ..self.control.clone()
                };
                Adaptive::of_control(&plain, &SubdivOptions::default())?
            }
        };
        let refined = adaptive.refine_into(&view, &how, &mut self.mesh);
        self.adaptive = Some((rules, adaptive));
        refined?;
        Ok(!self.mesh.truncated)
    }

    /// Makes the surface that is the same from everywhere, unless it is there.
    fn surface(&mut self, options: SmoothOptions) -> Result<()> {
        if self.uniform.as_ref().is_some_and(|u| u.0 == options) {
            return Ok(());
        }
        let Some(how) = options.how.uniform() else {
            return Ok(());
        };
        let control = ControlMesh {
            rules: options.rules(self.control.rules),
            ..self.control.clone()
        };
        let looks = SurfaceOptions {
            on_limit: false,
            normals: true,
        };
        let made = subdivide(&control, &how, looks, &Silent)?;
        self.uniform = Some((options, made.mesh));
        Ok(())
    }
}

impl Session for AdaptiveSession<'_> {
    fn answer(&mut self, message: &str) -> Result<Vec<u8>, LiveError> {
        let started = Instant::now();
        let request: Request<SmoothOptions> = Request::parse(message)?;
        self.order.check(request.seq)?;
        let complete = self.refine(&request)?;
        self.order.answered(request.seq);
        let mut flags = if complete {
            FLAG_COMPLETE
        } else {
            FLAG_TRUNCATED
        };
        if self.faces.is_full() {
            self.faces = Faces::new();
        }
        let known = self.faces.sent();
        if known == 0 {
            flags |= FLAG_RESET;
        }
        let uniform = self.uniform.as_ref().filter(|u| u.0 == request.options);
        let mesh = uniform.map_or(&self.mesh.mesh, |u| &u.1);
        let mut frame = Frame::default();
        self.faces.update(mesh, &mut frame);
        let corners = |f: &[u32]| (f[1] - f[0]).saturating_sub(2) as usize;
        let header = Header {
            kind: Kind::Adaptive,
            seq: request.seq,
            flags,
            triangles: mesh.offsets.windows(2).map(corners).sum(),
            microseconds: started.elapsed().as_micros(),
            changes: [mesh.face_count(), 0],
            level: 0.0,
        };
        Ok(frame.finish(&header, known))
    }
}
